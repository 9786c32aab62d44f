// SPDX-License-Identifier: Apache-2.0
// The journal on a disk that is full, fails to write, writes partially or fails to sync.
#include "server/store/journal_reader.h"
#include "server/store/journal_writer.h"
#include "tests/server/store/faulty_disk.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::journal_fault_test {
namespace {

using test::DiskFault;
using test::FaultRule;
using test::FaultTarget;

MoveTool move_to(double x_mm) {
  return MoveTool{.tool = 1, .to = {.tip_mm = {x_mm, 0, 0}}, .duration_s = 0.001};
}

/// A motion that a batch stores as a whole command, because it begins off the pose grid.
MoveTool large_move_to(double x_mm) {
  MoveTool move = move_to(x_mm);
  move.from.tip_mm.y = 1e-10;
  return move;
}

std::string name_of(const FaultRule& rule) {
  return "fault " + std::to_string(static_cast<int>(rule.fault)) + " of files " +
         std::to_string(static_cast<int>(rule.target)) + " after " +
         std::to_string(rule.after_bytes) + " bytes";
}

class JournalFaults : public testing::Test {
 protected:
  /// Returns the end points of all motions of a journal. An unreadable one fails the test.
  static std::vector<double> motions_of(const std::filesystem::path& path) {
    std::vector<double> found;
    auto reader = JournalReader::open(path);
    EXPECT_TRUE(reader) << describe(reader.error());
    if (!reader) return found;
    for (;;) {
      const auto record = reader->next();
      EXPECT_TRUE(record) << describe(record.error());
      if (!record || !*record) break;
      found.push_back(std::get<MoveTool>((*record)->command).to.tip_mm.x);
    }
    EXPECT_EQ(reader->dropped_hashes(), 0U) << "a hash was stored without its records";
    return found;
  }
  /// Appends the next motion. Returns false if the journal does not accept it.
  bool append(JournalWriter& writer) {
    const auto sequence = writer.append(1, move_to(static_cast<double>(accepted)));
    if (!sequence) return false;
    EXPECT_EQ(*sequence, ++accepted);
    return true;
  }
  /// Appends motions until the journal pauses.
  void append_until_paused(JournalWriter& writer) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!writer.pause() && std::chrono::steady_clock::now() < end) {
      append(writer);
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    ASSERT_TRUE(writer.pause());
  }
  /// Copies the files as a killed process would leave them, and reads the copy.
  std::vector<double> motions_after_a_crash() {
    const auto copy = folder / "crashed.kerf";
    remove_journal(copy);
    disk.hold([&] {
      for (const char* suffix : {"", "-wal"}) {
        std::error_code ignored;
        std::filesystem::copy_file(file.string() + suffix, copy.string() + suffix, ignored);
      }
    });
    disk.heal();
    return motions_of(copy);
  }
  void expect_prefix(const std::vector<double>& found, std::uint64_t at_least) const {
    EXPECT_GE(found.size(), at_least);
    EXPECT_LE(found.size(), accepted);
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], static_cast<double>(i));
  }

  test::FaultyDisk disk;
  test::TemporaryFolder folder;
  std::filesystem::path file = folder / "demo.kerf";
  JournalHeader header{"demo", "{}", "", 1};
  std::uint64_t accepted = 0;
};

TEST_F(JournalFaults, FailedGroupBlocksLaterWrites) {
  auto writer = JournalWriter::create(file, header);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(append(*writer));
  ASSERT_TRUE(writer->flush());
  for (const DiskFault fault :
       {DiskFault::kNoSpace, DiskFault::kIoError, DiskFault::kShortWrite, DiskFault::kSyncFails}) {
    SCOPED_TRACE(static_cast<int>(fault));
    const std::uint64_t durable = accepted;
    disk.fail({fault, FaultTarget::kAll, 0});
    append_until_paused(*writer);
    EXPECT_FALSE(append(*writer));
    EXPECT_EQ(writer->append(1, move_to(0)).error().code, JournalErrorCode::kIo);
    // These rows also stay in memory: a hash must not be stored before its record.
    writer->append(StateHash{accepted, 7});
    writer->append(JournalParticipant{2, "Ada", "#112233", "agent"});
    EXPECT_FALSE(writer->flush());
    EXPECT_GE(writer->lag(), 2U);
    const auto crashed = motions_after_a_crash();
    expect_prefix(crashed, durable);
    ASSERT_TRUE(writer->flush()) << "the disk works again";
    EXPECT_FALSE(writer->pause());
    EXPECT_EQ(writer->lag(), 0U);
    EXPECT_EQ(motions_of(file).size(), accepted);
    ASSERT_TRUE(append(*writer));
    ASSERT_TRUE(writer->flush());
  }
  const auto reader = JournalReader::open(file);
  EXPECT_EQ(reader->participants().size(), 1U);
  EXPECT_EQ(reader->state_hashes().size(), 4U);
}

TEST_F(JournalFaults, ContinuesByItselfAndReportsEachPauseOnce) {
  auto writer = JournalWriter::create(file, header);
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<bool> reports;
  writer->on_pause([&](const std::optional<JournalError>& error) {
    const std::lock_guard lock(mutex);
    reports.push_back(error.has_value());
    changed.notify_all();
  });
  const auto wait_for = [&](std::size_t count) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(30),
                            [&] { return reports.size() == count; });
  };
  disk.fail({DiskFault::kNoSpace, FaultTarget::kLog, 0});
  ASSERT_TRUE(append(*writer));
  ASSERT_TRUE(wait_for(1));
  while (writer->figures().failed_commits < 3) EXPECT_FALSE(writer->flush());
  disk.heal();
  ASSERT_TRUE(wait_for(2)) << "nobody calls flush: the journal itself tries again";
  EXPECT_EQ(reports, (std::vector<bool>{true, false}));
  EXPECT_FALSE(writer->pause());
  EXPECT_EQ(motions_of(file).size(), 1U);
}

TEST_F(JournalFaults, AFullDiskUnderTheDatabaseOnlyDelaysTheCheckpoint) {
  auto writer = JournalWriter::create(file, header);
  disk.fail({DiskFault::kNoSpace, FaultTarget::kDatabase, 0});
  // More than SQLite collects in its log before it copies it to the database.
  for (; accepted < 60'000; ++accepted) {
    ASSERT_TRUE(writer->append(1, large_move_to(static_cast<double>(accepted))));
  }
  EXPECT_TRUE(writer->flush());
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(append(*writer));
  EXPECT_TRUE(writer->flush());
  EXPECT_GT(disk.failures(), 0U);
  expect_prefix(motions_after_a_crash(), accepted);
}

TEST_F(JournalFaults, FinishOnAFullDiskReportsTheLossAndKeepsDurableRecords) {
  auto writer = JournalWriter::create(file, header);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(append(*writer));
  ASSERT_TRUE(writer->flush());
  disk.fail({DiskFault::kNoSpace, FaultTarget::kAll, 0});
  append_until_paused(*writer);
  EXPECT_EQ(test::error_of(writer->finish()).code, JournalErrorCode::kIo);
  EXPECT_FALSE(append(*writer));
  EXPECT_FALSE(writer->flush());
  disk.heal();
  expect_prefix(motions_of(file), 10);
}

TEST_F(JournalFaults, AJournalThatCannotBeCreatedLeavesNoFile) {
  for (std::uint64_t after = 0; after < 40'000; after += 3'000) {
    disk.fail({DiskFault::kNoSpace, FaultTarget::kAll, after});
    const auto writer = JournalWriter::create(file, header);
    if (writer) break;
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << after;
  }
  disk.heal();
  remove_journal(file);
  EXPECT_TRUE(JournalWriter::create(file, header));
}

TEST_F(JournalFaults, ReadingByParticipantIsOnePassAndChecksEveryRecord) {
  constexpr std::uint64_t kRecords = 20'000, kParticipants = 50;
  auto writer = JournalWriter::create(file, header);
  for (std::uint64_t n = 0; n < kRecords; ++n) {
    ASSERT_TRUE(
        writer->append(static_cast<ParticipantId>(1 + n % kParticipants), large_move_to(0)));
  }
  ASSERT_TRUE(writer->finish());
  const auto read = [&](RecordOrder order) {
    const std::uint64_t before = disk.bytes_read();
    auto reader = JournalReader::open(file, order);
    ParticipantId participant = 0;
    std::uint64_t sequence = 0, count = 0;
    for (auto record = reader->next(); record && *record; record = reader->next(), ++count) {
      if (order == RecordOrder::kParticipant && (*record)->participant != participant) {
        EXPECT_GT((*record)->participant, participant);
        participant = (*record)->participant;
        sequence = 0;
      }
      EXPECT_GT((*record)->sequence, std::exchange(sequence, (*record)->sequence));
    }
    EXPECT_EQ(count, kRecords);
    return disk.bytes_read() - before;
  };
  const std::uint64_t once = read(RecordOrder::kSequence);
  EXPECT_GE(once, kRecords * 100);
  EXPECT_LT(read(RecordOrder::kParticipant), 4 * once) << "the sorter's file included";
  std::stop_source stop;
  auto stopped = JournalReader::open(file, RecordOrder::kParticipant, stop.get_token());
  stop.request_stop();
  EXPECT_FALSE(stopped->next()) << "while it sorts";
}

TEST_F(JournalFaults, HashesBeyondTheLastRecordAreDropped) {
  {
    auto writer = JournalWriter::create(file, header);
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(append(*writer));
    writer->append(StateHash{8, 88});
    writer->append(StateHash{12, 99});  // written by a server after a failed group
  }
  {
    const auto reader = JournalReader::open(file);
    ASSERT_EQ(reader->state_hashes().size(), 1U);
    EXPECT_EQ(reader->state_hashes()[0].sequence, 8U);
    EXPECT_EQ(reader->dropped_hashes(), 1U);
  }
  auto writer = JournalWriter::open(file, 10);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(append(*writer));
  ASSERT_TRUE(writer->flush());
  const auto reader = JournalReader::open(file);
  ASSERT_EQ(reader->state_hashes().size(), 1U);
  EXPECT_EQ(reader->dropped_hashes(), 0U);
}

/// A journal under random faults, read after a crash at a random moment and after the disk has
/// recovered.
TEST_F(JournalFaults, AfterRandomFaultsTheJournalIsAPrefixWithEverythingDurable) {
  std::mt19937 random(20261122);
  const auto below = [&](std::uint64_t end) { return random() % end; };
  constexpr DiskFault kFaults[] = {DiskFault::kNoSpace, DiskFault::kIoError, DiskFault::kShortWrite,
                                   DiskFault::kSyncFails};
  constexpr FaultTarget kTargets[] = {FaultTarget::kAll, FaultTarget::kLog, FaultTarget::kDatabase};
  std::uint64_t pauses = 0;
  for (int life = 0; life < 25; ++life) {
    accepted = 0;
    disk.heal();
    remove_journal(file);
    auto writer = test::value_of(JournalWriter::create(file, header));
    std::uint64_t durable = 0;
    for (std::uint64_t round = 0; round < 1 + below(4); ++round) {
      const FaultRule rule{kFaults[below(4)], kTargets[below(3)], below(60'000)};
      SCOPED_TRACE("life " + std::to_string(life) + ": " + name_of(rule));
      if (below(5) != 0) disk.fail(rule);
      for (std::uint64_t step = 0; step < 1 + below(12); ++step) {
        for (std::uint64_t i = below(300); i-- > 0 && append(writer);) {
        }
        if (below(2) == 0 && accepted > 0) writer.append(StateHash{accepted, accepted});
        if (below(3) == 0 && writer.flush()) durable = accepted;
      }
      pauses += writer.figures().failed_commits;
      expect_prefix(motions_after_a_crash(), durable);  // heals the disk
      ASSERT_TRUE(writer.flush());
      durable = accepted;
      expect_prefix(motions_after_a_crash(), durable);
    }
    ASSERT_TRUE(writer.finish());
    const auto found = motions_of(file);
    EXPECT_EQ(found.size(), accepted);
    expect_prefix(found, durable);
    if (HasFailure()) return;
  }
  EXPECT_GT(pauses, 5U) << "the faults hit";
}

}  // namespace
}  // namespace kerf::journal_fault_test
