// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_change.h"

#include "server/store/attachment.h"
#include "server/store/journal_file.h"
#include "server/store/journal_reader.h"
#include "server/store/journal_tables.h"
#include "server/store/journal_writer.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::journal_change_test {
namespace {

ListChange stored(const std::string& name, std::int64_t record, const std::string& person) {
  return {.table = "versions", .stored = ListRow{name, record, record, record, "Ada", person}};
}

class JournalChangeTest : public testing::Test {
 protected:
  static void append_motions(JournalWriter& writer, int count) {
    for (int i = 0; i < count; ++i) {
      MoveTool move{.tool = 1, .to = {.tip_mm = {double(i), 0, 0}}, .duration_s = 0.001};
      ASSERT_TRUE(writer.append(1, move, {static_cast<std::uint64_t>(i + 1), i == 0}));
    }
    ASSERT_TRUE(writer.flush());
  }

  JournalWriter create() {
    auto writer =
        JournalWriter::create(file_, {"demo", "{}", "/scenes", 1, {{"part.stl", "mesh"}}});
    EXPECT_TRUE(writer);
    return *std::move(writer);
  }

  static void add_participant(JournalWriter& writer, ParticipantId id, const std::string& name) {
    writer.append(JournalParticipant{.participant = id,
                                     .name = name,
                                     .color = "#ff0000",
                                     .kind = "agent",
                                     .token = TokenHash{}});
    ASSERT_TRUE(writer.flush());
  }

  /// Returns all rows of all tables as text.
  static std::multiset<std::string> dump(const std::filesystem::path& file) {
    std::multiset<std::string> rows;
    auto database = open_journal(file, SqlMode::kRead);
    EXPECT_TRUE(database);
    for (const JournalTable& table : kJournalTables) {
      const auto exists = database->has_table(table.name);
      if (!exists || !*exists) continue;
      auto statement = database->prepare("SELECT * FROM " + std::string(table.name));
      EXPECT_TRUE(statement);
      while (*statement->step()) {
        std::string row(table.name);
        for (std::size_t n = 0; n < table.columns.size(); ++n) {
          row += '|' + statement->text(static_cast<int>(n));
        }
        rows.insert(row);
      }
    }
    return rows;
  }

  /// Applies all current changes.
  static void pass_on(JournalChanges& changes, JournalCopy& copy) {
    for (;;) {
      const auto change = test::value_of(changes.next());
      if (!change) return;
      const auto applied = copy.apply(*change);
      ASSERT_TRUE(applied) << describe(applied.error());
    }
  }

  const test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "demo.kerf", copied_ = folder_ / "copy.kerf";
};

TEST_F(JournalChangeTest, CopyHasEveryRowOfTheJournal) {
  JournalWriter writer = create();
  JournalChanges changes(file_);
  auto copy = test::value_of(JournalCopy::create(copied_));
  pass_on(changes, copy);
  add_participant(writer, 1, "Ada");
  append_motions(writer, 40);
  pass_on(changes, copy);
  writer.append(StateHash{40, 0x8000000000000042});
  writer.append(stored("half", 20, "grant"));
  writer.append(stored("first", 1, ""));
  append_motions(writer, 1000);
  pass_on(changes, copy);
  writer.append(ListChange{.table = "versions", .removed = "half"});
  add_participant(writer, 1, "Ada L.");
  pass_on(changes, copy);
  EXPECT_EQ(test::value_of(copy.finish()).record, 1040U);
  const auto rows = dump(file_);
  EXPECT_EQ(dump(copied_), rows);
  EXPECT_EQ(
      std::ranges::count_if(rows, [](const auto& row) { return row.starts_with("versions"); }), 1);
  EXPECT_EQ(std::ranges::count_if(rows, [](const auto& row) { return row.starts_with("files"); }),
            1);
}

TEST_F(JournalChangeTest, ResumedCopyHasEachWholeChangeAtOnce) {
  JournalWriter writer = create();
  JournalChanges changes(file_);
  append_motions(writer, 40);
  auto first = test::value_of(JournalCopy::create(copied_));
  pass_on(changes, first);
  const auto end = test::value_of(first.finish());
  auto copy = JournalCopy::resume(copied_, end);
  ASSERT_TRUE(copy);
  append_motions(writer, 40);
  writer.append(stored("half", 20, "grant"));
  ASSERT_TRUE(writer.flush());
  EXPECT_FALSE(copy->take_changed_lists());
  pass_on(changes, *copy);
  EXPECT_EQ(dump(copied_), dump(file_)) << "also the epoch";
  EXPECT_TRUE(copy->take_changed_lists());
  append_motions(writer, 10);
  auto change = changes.next();
  ASSERT_TRUE(change && *change);
  (*change)->is_whole = false;
  ASSERT_TRUE(copy->apply(**change));
  EXPECT_EQ(end_of_journal(copied_)->record, 80U) << "a part of a commit is not seen";
  copy = std::unexpected(JournalError{});
  EXPECT_EQ(end_of_journal(copied_)->record, 80U) << "nor kept";
  EXPECT_FALSE(JournalCopy::resume(copied_, end)->apply(**change)) << "it follows record 80";
}

AttachmentChange attached(const std::string& name, std::size_t bytes) {
  return {"grant", name, std::vector<std::byte>(bytes, std::byte{7})};
}

TEST_F(JournalChangeTest, AttachmentsAreCopiedReplacedAndRemoved) {
  JournalWriter writer = create();
  JournalChanges changes(file_);
  auto first = test::value_of(JournalCopy::create(copied_));
  writer.append(attached("a", 3));
  writer.append(attached("b", 4));
  ASSERT_TRUE(writer.flush());
  pass_on(changes, first);
  const auto end = test::value_of(first.finish());
  EXPECT_EQ(read_attachments(copied_)->size(), 2U);
  auto copy = test::value_of(JournalCopy::resume(copied_, end));
  EXPECT_FALSE(copy.take_changed_attachments());
  // The newest row is removed and another one is added: the number of rows stays the same.
  writer.append(AttachmentChange{"grant", "b"});
  writer.append(attached("c", 5));
  ASSERT_TRUE(writer.flush());
  pass_on(changes, copy);
  EXPECT_TRUE(copy.take_changed_attachments());
  EXPECT_EQ(dump(copied_), dump(file_));
  writer.append(attached("a", 6));
  ASSERT_TRUE(writer.flush());
  pass_on(changes, copy);
  EXPECT_EQ(dump(copied_), dump(file_));
  const auto copied = read_attachments(copied_);
  ASSERT_EQ(copied->size(), 2U);
  EXPECT_EQ(copied->back().name, "a") << "stored last";
  EXPECT_EQ(copied->back().bytes.size(), 6U);
  EXPECT_FALSE(*changes.next()) << "nothing is read twice";
  writer.append(AttachmentChange{});
  ASSERT_TRUE(writer.flush());
  pass_on(changes, copy);
  EXPECT_TRUE(read_attachments(copied_)->empty());
}

TEST_F(JournalChangeTest, LargeAttachmentsAreSplitAndOnlyTheLastPartIsWhole) {
  JournalWriter writer = create();
  for (const char* name : {"a", "b", "c"}) writer.append(attached(name, kChangeBytes));
  ASSERT_TRUE(writer.flush());
  JournalChanges changes(file_);
  auto copy = test::value_of(JournalCopy::create(copied_));
  for (const bool is_whole : {false, false, true}) {
    const auto change = changes.next();
    ASSERT_TRUE(change && *change);
    EXPECT_EQ((*change)->is_whole, is_whole);
    ASSERT_TRUE(copy.apply(**change));
  }
  EXPECT_FALSE(*changes.next());
  ASSERT_TRUE(copy.finish());
  EXPECT_EQ(dump(copied_), dump(file_));
}

TEST_F(JournalChangeTest, ADamagedAttachmentIsLeftOutAndAllCanBeRemovedFromAFile) {
  {
    JournalWriter writer = create();
    for (const char* name : {"a", "b"}) writer.append(attached(name, 3));
    ASSERT_TRUE(writer.flush());
  }
  auto database = SqlDatabase::open(file_, SqlMode::kWrite);
  ASSERT_TRUE(database);
  ASSERT_TRUE(database->execute("UPDATE attachments SET bytes=x'0102' WHERE name='a'"));
  database = std::unexpected(SqlError{});
  ASSERT_EQ(read_attachments(file_)->size(), 1U);
  ASSERT_TRUE(copy_journal(file_, copied_));
  ASSERT_TRUE(remove_attachments(copied_));
  EXPECT_TRUE(read_attachments(copied_)->empty());
  EXPECT_EQ(read_attachments(file_)->front().name, "b");
}

TEST_F(JournalChangeTest, CopyHasNoEpochUntilASessionRunsOnIt) {
  JournalChanges changes(file_);
  create();
  EXPECT_EQ(epoch_written(file_), 1U);
  auto first = test::value_of(JournalCopy::create(copied_));
  pass_on(changes, first);
  const auto end = test::value_of(first.finish());
  EXPECT_EQ(epoch_written(copied_), 0U);
  ASSERT_TRUE(JournalWriter::open(copied_, 0));
  EXPECT_EQ(epoch_written(copied_), 2U);
  ASSERT_TRUE(JournalCopy::resume(copied_, end));
  EXPECT_EQ(epoch_written(copied_), 0U);
}

TEST_F(JournalChangeTest, NothingIsReadTwice) {
  JournalWriter writer = create();
  append_motions(writer, 10);
  JournalChanges changes(file_);
  ASSERT_TRUE(*changes.next());
  EXPECT_FALSE(*changes.next());
  append_motions(writer, 10);
  const auto change = changes.next();
  ASSERT_TRUE(*change);
  EXPECT_EQ((*change)->before.record, 10U);
  EXPECT_EQ((*change)->after.record, 20U);
  EXPECT_LT((*change)->rows.size(), 300U);
}

TEST_F(JournalChangeTest, AnotherProcessContinuesTheCopy) {
  auto copy = test::value_of(JournalCopy::create(copied_));
  CopyPosition position;
  {
    JournalWriter writer = create();
    add_participant(writer, 1, "Ada");
    append_motions(writer, 100);
    writer.append(StateHash{100, 5});  // replaced by another kernel's
    ASSERT_TRUE(writer.flush());
    JournalChanges changes(file_);
    pass_on(changes, copy);
    position = changes.position();
  }
  auto writer = test::value_of(JournalWriter::open(file_, 100));
  writer.append_recarved(StateHash{100, 7});
  append_motions(writer, 5);
  JournalChanges changes(file_);
  ASSERT_TRUE(test::value_of(changes.begin(position)));
  pass_on(changes, copy);
  ASSERT_TRUE(copy.finish());
  EXPECT_EQ(dump(copied_), dump(file_));
}

TEST_F(JournalChangeTest, AnotherJournalDoesNotContinueTheCopy) {
  CopyPosition position;
  {
    JournalWriter writer = create();
    append_motions(writer, 100);
    JournalChanges changes(file_);
    ASSERT_TRUE(changes.next());
    position = changes.position();
  }
  JournalChanges same(file_);
  EXPECT_TRUE(*same.begin(position));
  remove_journal(file_);
  JournalWriter writer = create();
  append_motions(writer, 50);
  JournalChanges shorter(file_);
  EXPECT_FALSE(*shorter.begin(position)) << "it lacks records";
  append_motions(writer, 51);
  JournalChanges other(file_);
  EXPECT_FALSE(*other.begin(position)) << "it has other batches";
}

TEST_F(JournalChangeTest, ChangesAfterTheLastWholeOneAreLeftOut) {
  JournalWriter writer = create();
  JournalChanges changes(file_);
  auto copy = test::value_of(JournalCopy::create(copied_));
  append_motions(writer, 10);
  pass_on(changes, copy);
  const auto rows = dump(file_);
  append_motions(writer, 10);
  auto change = changes.next();
  ASSERT_TRUE(*change);
  (*change)->is_whole = false;
  ASSERT_TRUE(copy.apply(**change));
  EXPECT_EQ(test::value_of(copy.finish()).record, 10U);
  EXPECT_EQ(dump(copied_), rows);
}

TEST_F(JournalChangeTest, ContinuesFromTheLastWholeChange) {
  JournalWriter writer = create();
  JournalChanges changes(file_);
  auto copy = test::value_of(JournalCopy::create(copied_));
  append_motions(writer, 10);
  pass_on(changes, copy);
  const CopyPosition whole = changes.position();
  append_motions(writer, 10);
  auto change = changes.next();
  ASSERT_TRUE(*change);
  (*change)->is_whole = false;
  ASSERT_TRUE(copy.apply(**change));
  JournalChanges successor(file_);
  ASSERT_TRUE(*successor.begin(whole));
  append_motions(writer, 10);
  pass_on(successor, copy);
  EXPECT_EQ(test::value_of(copy.finish()).record, 30U);
  EXPECT_EQ(dump(copied_), dump(file_));
}

TEST_F(JournalChangeTest, EndOfAJournalEqualsThatOfItsCopy) {
  JournalWriter writer = create();
  JournalChanges changes(file_);
  ASSERT_TRUE(changes.next());
  EXPECT_EQ(end_of_journal(file_)->record, 0U);
  EXPECT_TRUE(*JournalChanges(file_).begin(*end_of_journal(file_)));
  append_motions(writer, 10);
  ASSERT_TRUE(changes.next());
  EXPECT_EQ(*end_of_journal(file_), changes.position());
  EXPECT_FALSE(end_of_journal(folder_ / "none.kerf"));
}

TEST_F(JournalChangeTest, ACopyWithoutAWholeChangeIsNotFinished) {
  JournalWriter writer = create();
  append_motions(writer, 10);
  {
    EXPECT_FALSE(test::value_of(JournalCopy::create(copied_)).finish());
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 3)
      << "more than the journal and its side files is left";
}

TEST_F(JournalChangeTest, NonconsecutiveOrMalformedChangesAreRejected) {
  JournalWriter writer = create();
  append_motions(writer, 10);
  JournalChanges changes(file_);
  const auto first = changes.next();
  append_motions(writer, 10);
  const auto second = changes.next();
  auto copy = test::value_of(JournalCopy::create(copied_));
  EXPECT_EQ(copy.apply(**second).error().code, JournalErrorCode::kCorrupt);
  JournalChange foreign = **first;
  foreign.rows.back() = std::byte{0xFF};
  foreign.rows.push_back(std::byte{99});
  EXPECT_EQ(copy.apply(foreign).error().code, JournalErrorCode::kCorrupt);
  JournalChange cut = **first;
  cut.rows.pop_back();
  auto other = JournalCopy::create(folder_ / "other.kerf").value();
  EXPECT_EQ(other.apply(cut).error().code, JournalErrorCode::kCorrupt);
}

TEST_F(JournalChangeTest, ACopyWithADamagedRecordIsNotFinished) {
  JournalWriter writer = create();
  append_motions(writer, 100);
  JournalChanges changes(file_);
  auto change = changes.next();
  ASSERT_TRUE(*change);
  // The batch follows the origin. Its bytes are the longest run of the rows.
  auto& rows = (*change)->rows;
  rows[rows.size() / 2] ^= std::byte{1};
  auto copy = test::value_of(JournalCopy::create(copied_));
  EXPECT_TRUE(!copy.apply(**change) || !copy.finish());
  EXPECT_FALSE(std::filesystem::exists(copied_));
}

}  // namespace
}  // namespace kerf::journal_change_test
