// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/takeover.h"

#include "server/cluster/change_frame.h"
#include "server/store/attachment.h"
#include "server/store/journal_change.h"
#include "server/store/journal_file.h"
#include "server/store/journal_writer.h"
#include "tests/server/cluster/nats_fixture.h"
#include "tests/support/test.h"

namespace kerf::takeover_test {
namespace {

class TakeoverTest : public test::NatsTest {
 protected:
  void SetUp() override {
    NatsTest::SetUp();
    if (!nats_) return;
    ASSERT_TRUE(nats_->make_stream(copy_stream("demo"), copy_subject("demo"), 1));
  }
  JournalWriter create(const std::filesystem::path& file) {
    auto writer = JournalWriter::create(file, {"demo", "{}", {}, 1});
    EXPECT_TRUE(writer);
    return *std::move(writer);
  }
  static void append(JournalWriter& writer, int count) {
    for (int n = 0; n < count; ++n) {
      MoveTool move{.to = {.tip_mm = {double(n), 0, 0}}};
      ASSERT_TRUE(writer.append(1, move));
    }
    ASSERT_TRUE(writer.flush());
  }
  /// Copies new rows like an owner of epoch 2, after its message `after`.
  NatsResult<std::uint64_t> copy(JournalChanges& changes, std::uint64_t after,
                                 bool is_whole = true) {
    const auto change = changes.next();
    EXPECT_TRUE(change && *change);
    const FrameHead head{.epoch = 2,
                         .writer = 7,
                         .change = after + 1,
                         .is_whole = is_whole,
                         .before = (*change)->before,
                         .after = (*change)->after};
    return nats_->publish(copy_subject("demo"), encode_frame(head, (*change)->rows),
                          std::to_string(after), after);
  }
  std::uint64_t records(const std::filesystem::path& file) { return end_of_journal(file)->record; }

  const std::filesystem::path first_ = folder_ / "first.kerf", second_ = folder_ / "second.kerf",
                              third_ = folder_ / "third.kerf", kept_ = folder_ / "closed";
};

TEST_F(TakeoverTest, FormerOwnerCannotExtendTheCopy) {
  JournalWriter writer = create(first_);
  JournalChanges changes(first_);
  append(writer, 5);
  const auto last = test::value_of(copy(changes, 0));
  const auto prepared = prepare_journal(*nats_, "demo", 3, second_, kept_);
  ASSERT_TRUE(prepared) << prepared.error();
  EXPECT_EQ(records(second_), 5U);
  append(writer, 5);
  EXPECT_EQ(test::error_of(copy(changes, last)).code, NatsErrorCode::kNotNext);
  EXPECT_EQ(epoch_of_copy(*nats_, "demo"), 2U) << "the owner of epoch 3 may go on";
  EXPECT_FALSE(prepare_journal(*nats_, "demo", 2, folder_ / "third.kerf", kept_));
}

TEST_F(TakeoverTest, CurrentJournalStaysAndStaleOneIsReplaced) {
  {
    JournalWriter writer = create(first_);
    JournalChanges changes(first_);
    append(writer, 5);
    ASSERT_TRUE(copy_journal(first_, second_));
    append(writer, 5);
    ASSERT_TRUE(copy(changes, 0));
    append(writer, 5);
  }
  ASSERT_TRUE(prepare_journal(*nats_, "demo", 3, first_, kept_));
  EXPECT_EQ(records(first_), 15U) << "it has more than the copy";
  ASSERT_TRUE(prepare_journal(*nats_, "demo", 4, second_, kept_));
  EXPECT_EQ(records(second_), 10U);
  EXPECT_FALSE(std::filesystem::exists(kept_)) << "the copy has all of it";
}

TEST_F(TakeoverTest, StaleEpochJournalHoldsRecordsOnly) {
  std::uint64_t last = 0;
  {
    JournalWriter writer = create(first_);
    append(writer, 5);
    ASSERT_TRUE(copy_journal(first_, second_));
    ASSERT_TRUE(copy_journal(first_, third_));
    JournalChanges changes(first_);
    last = *copy(changes, 0);
    // A later owner, of epoch 2, which adds no record.
    JournalWriter later = *JournalWriter::open(second_, 5);
    later.append(AttachmentChange{"grant", "g", std::vector<std::byte>(3)});
    ASSERT_TRUE(later.flush());
    JournalChanges more(second_);
    ASSERT_TRUE(*more.begin(changes.position()));
    ASSERT_TRUE(copy(more, last));
  }
  ASSERT_TRUE(prepare_journal(*nats_, "demo", 3, third_, kept_, true));
  EXPECT_TRUE(read_attachments(third_)->empty()) << "it has followed the copy until now";
  ASSERT_TRUE(prepare_journal(*nats_, "demo", 4, second_, kept_));
  EXPECT_EQ(epoch_written(second_).value_or(0), 2U) << "that of the later owner stays";
  ASSERT_TRUE(prepare_journal(*nats_, "demo", 5, third_, kept_));
  EXPECT_EQ(read_attachments(third_)->size(), 1U);
  EXPECT_FALSE(std::filesystem::exists(kept_)) << "nothing was lost with it";
  ASSERT_TRUE(prepare_following(*nats_, "demo", first_, kept_));
  EXPECT_EQ(read_attachments(first_)->size(), 1U) << "who follows has what is no record too";
}

TEST_F(TakeoverTest, DivergedJournalIsKeptAside) {
  JournalWriter writer = create(first_);
  JournalChanges changes(first_);
  append(writer, 5);
  ASSERT_TRUE(copy(changes, 0));
  {
    JournalWriter other = create(second_);
    append(other, 7);
  }
  ASSERT_TRUE(prepare_journal(*nats_, "demo", 3, second_, kept_));
  EXPECT_EQ(records(second_), 5U);
  const auto kept = std::filesystem::directory_iterator(kept_);
  ASSERT_NE(kept, std::filesystem::directory_iterator());
  EXPECT_EQ(records(kept->path()), 7U);
}

TEST_F(TakeoverTest, CopyEndingInACommitContinuesFromTheLastWholeOne) {
  JournalWriter writer = create(first_);
  JournalChanges changes(first_);
  append(writer, 5);
  const auto whole = copy(changes, 0);
  append(writer, 5);
  ASSERT_TRUE(copy(changes, *whole, false));
  ASSERT_TRUE(prepare_journal(*nats_, "demo", 3, second_, kept_));
  EXPECT_EQ(records(second_), 5U);
  const auto last = nats_->last_message(copy_stream("demo"), copy_subject("demo"));
  const auto frame = test::value_of(decode_frame((**last).bytes));
  EXPECT_TRUE(*JournalChanges(second_).begin(frame.head.position())) << "a replica continues it";
  ASSERT_TRUE(prepare_journal(*nats_, "demo", 4, folder_ / "third.kerf", kept_));
  EXPECT_EQ(records(folder_ / "third.kerf"), 5U);
}

TEST_F(TakeoverTest, WithoutACopyTheLocalJournalCounts) {
  EXPECT_FALSE(prepare_journal(*nats_, "demo", 1, second_, kept_));
  create(first_);
  EXPECT_TRUE(prepare_journal(*nats_, "demo", 1, first_, kept_));
  EXPECT_EQ(epoch_of_copy(*nats_, "demo"), 0U);
}

}  // namespace
}  // namespace kerf::takeover_test
