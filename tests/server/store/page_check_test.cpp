// SPDX-License-Identifier: Apache-2.0
#include "server/store/page_check.h"

#include "server/store/journal_file.h"
#include "server/store/journal_tables.h"
#include "server/store/journal_writer.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::page_check_test {
namespace {

constexpr std::size_t kSchemaPage = 4096;  ///< the first page of the file has the schema

/// Writes a journal that has every table.
void write_journal(const std::filesystem::path& file) {
  ASSERT_TRUE(JournalWriter::create(file, {"demo", "{}", "", 1}));
  auto database = test::value_of(open_journal(file, SqlMode::kWrite));
  for (const JournalTable& table : kJournalTables) {
    if (!table.create.empty()) {
      ASSERT_TRUE(database.execute(std::string(table.create)));
    }
  }
}

TEST(PageCheck, AcceptsAJournalWithEveryTable) {
  const test::TemporaryFolder folder;
  write_journal(folder / "demo.kerf");
  const auto checked = check_pages(folder / "demo.kerf");
  EXPECT_TRUE(checked) << describe(checked.error());
}

/// A reader takes such a table for one that the journal does not have, and its rows are gone.
TEST(PageCheck, ReportsEachFlippedBitInTheNamesOfTables) {
  const test::TemporaryFolder folder;
  const auto file = folder / "demo.kerf";
  write_journal(file);
  const std::string intact = test::content_of(file);
  for (const JournalTable& table : kJournalTables) {
    const std::string name(table.name);
    int places = 0;
    for (auto at = intact.find(name); at < kSchemaPage; at = intact.find(name, at + 1)) {
      ++places;
      for (int bit = 0; bit < 8; ++bit) {
        std::string damaged = intact;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << bit));
        std::ofstream(file, std::ios::binary) << damaged;
        // SQLite does not distinguish capital letters in the statement that has created the table.
        auto opened = open_journal(file, SqlMode::kRead);
        const auto found = opened ? opened->has_table(name) : SqlResult<bool>(false);
        const bool is_lost = !found || !*found;
        EXPECT_TRUE(!is_lost || !check_pages(file)) << name << ", byte " << at << ", bit " << bit;
      }
    }
    EXPECT_GE(places, 3) << name;
  }
}

}  // namespace
}  // namespace kerf::page_check_test
