// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/snapshot_copy.h"

#include "server/cluster/change_frame.h"
#include "server/cluster/copies.h"
#include "server/cluster/journal_replica.h"
#include "server/session/replay.h"
#include "server/store/block_snapshot.h"
#include "server/store/journal_file.h"
#include "server/store/journal_reader.h"
#include "server/store/journal_writer.h"
#include "tests/server/cluster/nats_fixture.h"
#include "tests/support/test.h"

namespace kerf::snapshot_copy_test {
namespace {

constexpr const char* kScene =
    R"({"stock":{"shape":"box","min_mm":[-10,-10,-10],"max_mm":[10,10,0]},
        "accuracy":{"rays":"dexel","pitch_mm":0.5,"tolerance_mm":0.01,"motion":"tight"},
        "tools":[{"id":1,"shape":"ball","diameter_mm":4,"length_mm":20}]})";

class SnapshotCopyTest : public test::NatsTest {
 protected:
  void SetUp() override {
    NatsTest::SetUp();
    if (!nats_) return;
    auto writer = test::value_of(JournalWriter::create(first_, {"demo", kScene, {}, 1}));
    writer_.emplace(std::move(writer));
    ASSERT_TRUE(writer_->append(
        0, DefineTool{1, make_tool(std::vector<ToolPiece>{BallPiece{2, 2}}).value()}));
  }
  /// Cuts, and writes a snapshot like a session. Returns its last record.
  std::uint64_t cut_and_write(int motions) {
    for (int n = 0; n < motions; ++n) {
      const double x = 0.01 * cut_++;
      MoveTool move{1, {{x, 0, -1}, {0, 0, 1}}, {{x + 0.01, 0, -1}, {0, 0, 1}}, 0.001, false};
      EXPECT_TRUE(writer_->append(1, move));
    }
    EXPECT_TRUE(writer_->flush());
    auto replayed = replay(first_);
    EXPECT_TRUE(replayed);
    const std::uint64_t record = replayed->last_sequence;
    const auto mark = JournalReader::open(first_)->mark(record);
    const SnapshotHead head{.kernel_version = kKernelVersion,
                            .session = "demo",
                            .sequence = record,
                            .hash = replayed->hash.hash,
                            .mark = mark->value()};
    EXPECT_TRUE(write_snapshot(snapshot_file(first_), head, replayed->sculpture.state()));
    return record;
  }
  SnapshotCopy owner(std::uint32_t epoch) { return {*nats_, {"demo", first_, epoch}, 1}; }
  /// Restores journal and snapshots at another server, in epoch 9.
  std::expected<Replayed, JournalError> take_over() {
    remove_journal(second_);
    EXPECT_TRUE(copy_journal(first_, second_));
    fetched_ = fetch_snapshots(*nats_, "demo", 9, second_);
    return restore(second_);
  }
  std::uint64_t messages_from() {
    std::uint64_t first = 0;
    EXPECT_TRUE(nats_->read(snapshot_stream("demo"), snapshot_subject("demo"),
                            [&](const StreamMessage& message) {
                              first = message.sequence;
                              return false;
                            }));
    return first;
  }
  void store(std::span<const std::byte> bytes) {
    const auto last = nats_->last_message(snapshot_stream("demo"), snapshot_subject("demo"));
    ASSERT_TRUE(last && *last);
    ASSERT_TRUE(nats_->publish(snapshot_subject("demo"), bytes,
                               "test/" + std::to_string((*last)->sequence), (*last)->sequence));
  }

  const std::filesystem::path first_ = folder_ / "first.kerf", second_ = folder_ / "second.kerf";
  std::optional<JournalWriter> writer_;
  int cut_ = 0;
  const std::stop_token never_;
  std::expected<std::uint64_t, std::string> fetched_;
};

TEST_F(SnapshotCopyTest, TakeoverReplaysOnlyRecordsAfterTheNewestSnapshot) {
  SnapshotCopy copy = owner(2);
  const std::uint64_t before = cut_and_write(20);
  ASSERT_EQ(copy.copy(before, never_), true);
  const std::uint64_t newest = cut_and_write(20);
  EXPECT_EQ(copy.copy(newest - 1, never_), false) << "the copy of the journal is behind it";
  ASSERT_EQ(copy.copy(newest, never_), true);
  EXPECT_EQ(copy.copy(newest, never_), false) << "it is there already";
  EXPECT_EQ(copy.record(), newest);
  ASSERT_TRUE(writer_->append(1, MoveTool{1, {{0, 2, -1}, {0, 0, 1}}, {{0, 3, -1}, {0, 0, 1}}}));
  ASSERT_TRUE(writer_->flush());
  const auto taken = test::value_of(take_over());
  EXPECT_EQ(fetched_, newest);
  EXPECT_EQ(taken.snapshot, UsedSnapshot::kNewest);
  EXPECT_EQ(taken.snapshot_sequence, newest);
  EXPECT_EQ(taken.hash.hash, replay(first_)->hash.hash);
  EXPECT_EQ(read_snapshot_head(previous_snapshot_file(second_))->sequence, before);
}

TEST_F(SnapshotCopyTest, StreamKeepsTwoSnapshots) {
  SnapshotCopy copy = owner(2);
  for (int n = 0; n < 5; ++n) ASSERT_EQ(copy.copy(cut_and_write(5), never_), true);
  EXPECT_EQ(messages_from(), 4U) << "each is one message";
}

TEST_F(SnapshotCopyTest, DamagedSnapshotIsSkippedForTheOneBefore) {
  SnapshotCopy copy = owner(2);
  const std::uint64_t good = cut_and_write(20);
  ASSERT_EQ(copy.copy(good, never_), true);
  const std::uint64_t newest = cut_and_write(20);
  std::ifstream file(snapshot_file(first_), std::ios::binary);
  std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  bytes[bytes.size() / 2] ^= 1;  // the message's own checksum is right
  const FrameHead head{.epoch = 2,
                       .writer = 1,
                       .change = 9,
                       .before = {.record = good},
                       .after = {.record = newest}};
  store(encode_frame(head, std::as_bytes(std::span(bytes))));
  const auto taken = test::value_of(take_over());
  EXPECT_EQ(taken.snapshot, UsedSnapshot::kPrevious);
  EXPECT_EQ(taken.snapshot_sequence, good);
  EXPECT_NE(taken.snapshot_fault, "");
  EXPECT_EQ(taken.hash.hash, replay(first_)->hash.hash);
}

TEST_F(SnapshotCopyTest, UnfinishedSnapshotIsIgnored) {
  SnapshotCopy copy = owner(2);
  const std::uint64_t good = cut_and_write(20);
  ASSERT_EQ(copy.copy(good, never_), true);
  const std::vector<std::byte> bytes(100);
  const FrameHead half{.epoch = 2,
                       .writer = 1,
                       .change = 9,
                       .part = 0,
                       .parts = 2,
                       .before = {.record = good},
                       .after = {.record = good + 5}};
  store(encode_frame(half, bytes));
  EXPECT_EQ(test::value_of(take_over()).snapshot_sequence, good);
  SnapshotCopy next = owner(3);
  const std::uint64_t newest = cut_and_write(20);
  ASSERT_EQ(next.copy(newest, never_), true);
  EXPECT_EQ(take_over()->snapshot_sequence, newest);
}

TEST_F(SnapshotCopyTest, AllRecordsAreReplayedWithoutAUsableSnapshot) {
  SnapshotCopy copy = owner(2);
  ASSERT_EQ(copy.copy(cut_and_write(20), never_), true);
  ASSERT_TRUE(nats_->purge(snapshot_stream("demo"), 2));
  ASSERT_TRUE(nats_->publish(snapshot_subject("demo"), std::vector<std::byte>(10), "bad", 0));
  const auto taken = test::value_of(take_over());
  EXPECT_FALSE(fetched_);
  EXPECT_EQ(taken.snapshot, UsedSnapshot::kNone);
  EXPECT_EQ(taken.hash.hash, replay(first_)->hash.hash);
}

TEST_F(SnapshotCopyTest, FormerOwnerAddsNothingAndLaterEpochsAreSkipped) {
  SnapshotCopy former = owner(2), later = owner(3);
  ASSERT_EQ(former.copy(cut_and_write(5), never_), true);
  const std::uint64_t newest = cut_and_write(5);
  ASSERT_EQ(later.copy(newest, never_), true);
  const std::uint64_t late = cut_and_write(5);
  EXPECT_FALSE(former.copy(late, never_)) << "the stream has other messages than it knows";
  const auto error = test::error_of(former.copy(late, never_));
  EXPECT_NE(error.find("epoch 3"), std::string::npos) << error;
  EXPECT_FALSE(fetch_snapshots(*nats_, "demo", 3, second_));
  EXPECT_EQ(fetch_snapshots(*nats_, "demo", 4, second_), newest);
}

TEST_F(SnapshotCopyTest, LargeSnapshotIsSentInPartsAndNewerLocalOneStays) {
  std::vector<std::byte> bytes(3 * kFrameBytes + 5);
  for (std::size_t n = 0; n < bytes.size(); ++n) bytes[n] = std::byte(n * 2654435761U >> 13);
  const std::uint64_t record = cut_and_write(5);
  std::ofstream(snapshot_file(first_), std::ios::binary | std::ios::app)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  SnapshotCopy copy = owner(2);
  ASSERT_EQ(copy.copy(record, never_), true);
  ASSERT_EQ(fetch_snapshots(*nats_, "demo", 3, second_), record);
  const auto read = [](const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return std::vector<char>{std::istreambuf_iterator<char>(in), {}};
  };
  EXPECT_EQ(read(snapshot_file(second_)), read(snapshot_file(first_)));
  const std::uint64_t newer = cut_and_write(5);
  EXPECT_EQ(fetch_snapshots(*nats_, "demo", 3, first_), newer);
  EXPECT_EQ(read_snapshot_head(snapshot_file(first_))->sequence, newer);
}

/// The commands of kerf-server and their output.
TEST_F(SnapshotCopyTest, CopyIsListedFetchedAndForgottenWithItsSnapshot) {
  const std::uint64_t record = cut_and_write(20);
  {
    JournalReplica replica(*nats_, {"demo", first_, 2}, 1, [](const CopyState&) {});
    ASSERT_TRUE(replica.finish(Clock::now() + std::chrono::seconds(30)));
  }
  ASSERT_EQ(owner(2).copy(record, never_), true);
  const auto printed = [](const std::string& url) {
    testing::internal::CaptureStdout();
    EXPECT_EQ(print_copies(url), 0);
    return testing::internal::GetCapturedStdout();
  };
  const std::string listed = "demo: " + std::to_string(record) + " records, epoch 2\n";
  EXPECT_EQ(printed(process_.url()), listed);
  const std::string away = "nats://ada:secret@127.0.0.1:" + std::to_string(test::free_port());
  EXPECT_EQ(printed(away + "," + process_.url()), listed) << "any of a list serves";
  const auto complaint = [](const auto& command) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(command(), 1);
    return testing::internal::GetCapturedStderr();
  };
  const std::string none = complaint([&] { return print_copies(away); });
  EXPECT_TRUE(none.contains("NATS cannot be reached")) << none;
  EXPECT_FALSE(none.contains("secret")) << none;

  ASSERT_EQ(fetch_journal(process_.url(), "demo", second_), 0);
  const auto fetched = test::value_of(restore(second_));
  EXPECT_EQ(fetched.snapshot, UsedSnapshot::kNewest);
  EXPECT_EQ(fetched.snapshot_sequence, record);
  EXPECT_EQ(fetched.hash.hash, replay(first_)->hash.hash);

  ASSERT_EQ(forget_copy(process_.url(), "demo"), 0);
  EXPECT_TRUE(nats_->streams()->empty()) << "neither journal nor snapshots";
  EXPECT_EQ(printed(process_.url()), "");
  const auto third = folder_ / "third.kerf";
  const std::string forgotten =
      complaint([&] { return fetch_journal(process_.url(), "demo", third); });
  EXPECT_TRUE(forgotten.contains("there is no copy of session demo")) << forgotten;
  EXPECT_FALSE(std::filesystem::exists(third));
}

}  // namespace
}  // namespace kerf::snapshot_copy_test
