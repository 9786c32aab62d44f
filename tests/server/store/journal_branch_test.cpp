// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_branch.h"

#include "server/store/journal_file.h"
#include "server/store/journal_reader.h"
#include "server/store/journal_writer.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::journal_branch_test {
namespace {

/// Writes a journal of ten motions like an old server that did not store its kernel version; this
/// kernel carved it again after the tenth.
void write_carved_again(const std::filesystem::path& file) {
  {
    auto writer = test::value_of(JournalWriter::create(file, {"demo", "{}", "", 1}));
    for (int i = 1; i <= 10; ++i) {
      MoveTool move{.tool = 1, .to = {.tip_mm = {double(i), 0, 0}}, .duration_s = 0.001};
      ASSERT_TRUE(writer.append(1, move));
    }
    ASSERT_TRUE(writer.flush());
  }
  auto database = test::value_of(open_journal(file, SqlMode::kWrite));
  ASSERT_TRUE(database.execute("DELETE FROM kernel_versions"));
  auto writer = test::value_of(JournalWriter::open(file, 10));
  writer.append_recarved(StateHash{10, 42});
  ASSERT_TRUE(writer.flush());
}

TEST(JournalBranch, StatesTheKernelOfItsRecordsOnly) {
  const test::TemporaryFolder folder;
  const std::filesystem::path parent = folder / "demo.kerf";
  write_carved_again(parent);
  for (const auto& [record, version] :
       {std::pair{10, kKernelVersion}, std::pair{5, kFirstKernelVersion}}) {
    const std::filesystem::path file = folder / ("branch" + std::to_string(record) + ".kerf");
    const auto branched =
        branch_journal(parent, file, "branch", {"demo", static_cast<std::uint64_t>(record), 1, 0});
    ASSERT_TRUE(branched) << describe(branched.error());
    EXPECT_EQ(JournalReader::open(file)->header().kernel_version, version) << record;
  }
}

}  // namespace
}  // namespace kerf::journal_branch_test
