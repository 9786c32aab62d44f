// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>

#include <csignal>

#include "server/matters.h"
#include "server/session/journal_check.h"
#include "server/store/journal_times.h"
#include "server/store/record_rows.h"
#include "server/versions/versions.h"
#include "tests/server/undo_fixture.h"
#include "tests/support/test.h"

namespace kerf::session_branch_test {
namespace {

NamedVersion named(const std::string& name, std::uint64_t record) {
  return {name, record, 1000, 2000, "Ada", ""};
}

class Branches : public SessionUndo {
 protected:
  Branches() { matters_ = net::matters(); }
  std::shared_ptr<Session> branch(const std::string& id, std::uint64_t record) {
    auto created = registry_->branch(id, *session_, record);
    EXPECT_TRUE(created) << created.error().reason;
    return created.value_or(nullptr);
  }
  std::uint64_t hash_at(std::uint64_t record) {
    SerialWorkers alone;
    return session_->past().solid_at(record, alone).value().value().hash();
  }
  /// Makes strokes, some of them undone, in several commits.
  void carve() {
    create();
    ada_ = join("Ada");
    bo_ = join("Bo");
    a_ = stroke(ada_, {-15, 0, -2}, {15, 0, -2});
    b_ = stroke(bo_, {0, -15, -3}, {0, 15, -3});
    undo({a_});
    c_ = stroke(ada_, {-15, 8, -2}, {15, 8, -2});
    undo({b_});
    redo({a_});
  }

  ParticipantId ada_ = 0, bo_ = 0;
  StrokeId a_ = 0, b_ = 0, c_ = 0;
};

TEST_F(Branches, BeginAsTheParentWasToTheBit) {
  carve();
  ASSERT_TRUE(session_->matters().get<Versions>().name(named("early", b_)));
  ASSERT_TRUE(session_->matters().get<Versions>().name(named("late", session_->sequence())));
  const std::uint64_t now = hash(), last = session_->sequence();
  int number = 0;
  for (const std::uint64_t record : {last, a_ + 3, b_ + 20, c_, last - 1}) {
    const auto other = branch("branch" + std::to_string(++number), record);
    ASSERT_TRUE(other);
    EXPECT_EQ(other->solid().hash(), hash_at(record)) << record;
    EXPECT_EQ(other->sequence(), record);
    EXPECT_EQ(other->parent().session, "block");
    EXPECT_EQ(other->parent().record, record);
    EXPECT_EQ(other->parent().epoch, session_->epoch());
    EXPECT_EQ(other->matters().record_named("early").has_value(), record >= b_);
    EXPECT_EQ(other->matters().record_named("late").has_value(), record == last);
    const std::int64_t ms = time_of(other->journal_file(), record - 1).value() -
                            time_of(session_->journal_file(), record - 1).value();
    EXPECT_LE(std::abs(ms), 1);
    const auto verified = test::value_of(verify_journal(other->journal_file()));
    EXPECT_EQ(verified.difference, "");
    EXPECT_EQ(verified.hash, hash_at(record));
    close(other->id());
  }
  EXPECT_EQ(hash(), now);
  EXPECT_EQ(session_->sequence(), last);
}

TEST_F(Branches, UndoStrokesOfTheParent) {
  carve();
  const std::uint64_t parent_hash = hash(), parent_last = session_->sequence();
  auto parent = std::exchange(session_, branch("other", c_ + 19));
  EXPECT_EQ(session_->past().strokes(0)->size(), 3U);
  // Strokes undone at the branch can be redone, and the rest undone.
  redo({a_});
  EXPECT_EQ(hash(), never_happened());
  undo({b_});
  EXPECT_EQ(hash(), never_happened());
  const ParticipantId cy = join("Cy");
  EXPECT_GT(cy, bo_);
  stroke(cy, {-15, -8, -2}, {15, -8, -2});
  EXPECT_EQ(hash(), never_happened());
  const std::uint64_t expected = hash();
  EXPECT_EQ(parent->solid().hash(), parent_hash);
  EXPECT_EQ(parent->sequence(), parent_last);
  // The branch needs nothing of its parent after a restart.
  executor_->run();
  session_.reset();
  const auto parent_file = parent->journal_file();
  parent.reset();
  registry_.reset();
  remove_journal(parent_file);
  restart();
  EXPECT_TRUE(registry_->load_all().failures.empty());
  session_ = registry_->find("other");
  ASSERT_TRUE(session_);
  EXPECT_EQ(hash(), expected);
  EXPECT_EQ(session_->parent().session, "block");
  EXPECT_EQ(session_->past().strokes(0)->size(), 4U);
}

TEST_F(Branches, FromTheUntouchedBlockHaveItsTools) {
  carve();
  session_ = branch("fresh", 0);
  EXPECT_EQ(hash(), Sculpture::create(session_->scene()->settings)->state_hash());
  stroke(join("Cy"), {-15, 0, -2}, {15, 0, -2});
  EXPECT_EQ(hash(), never_happened());
  EXPECT_NE(hash(), Sculpture::create(session_->scene()->settings)->state_hash());
}

TEST_F(Branches, HaveNoAgentsOfTheParent) {
  create();
  JoinRequest request{ParticipantKind::kAgent, "Ada", "", 1, true};
  request.durable = true;
  const auto admitted = test::value_of(session_->admit(request));
  request.token = admitted.token;
  session_ = branch("other", session_->sequence());
  const auto joined = test::value_of(session_->admit(request));
  EXPECT_FALSE(joined.resumed);
  EXPECT_GT(joined.participant.id, admitted.participant.id);
}

TEST_F(Branches, FromVersion1HaveItsRecords) {
  carve();
  ASSERT_TRUE(session_->flush());
  std::vector<JournalRecord> records;
  auto reader = JournalReader::open(session_->journal_file());
  // Records of version 1 belong to no stroke.
  for (auto record = reader->next(); record && *record; record = reader->next()) {
    if (!std::holds_alternative<StrokeChange>((*record)->command)) records.push_back(**record);
  }
  const JournalHeader header = reader->header();
  const auto old = folder_->path() / "old.kerf", copy = folder_->path() / "copy.kerf";
  {
    auto database = test::value_of(create_journal(old, header));
    ASSERT_TRUE(database.execute(
        "DROP TABLE batches; DROP TABLE versions; CREATE TABLE commands(sequence INTEGER PRIMARY "
        "KEY, participant INTEGER NOT NULL, bytes BLOB NOT NULL, crc INTEGER NOT NULL); PRAGMA "
        "user_version=1"));
    auto insert = database.prepare("INSERT INTO commands VALUES(?,?,?,?)");
    for (std::size_t n = 0; n < records.size(); ++n) {
      const auto bytes = encode_command(records[n].command);
      insert->bind(1, static_cast<std::int64_t>(n + 1));
      insert->bind(2, std::int64_t{records[n].participant});
      insert->bind(3, std::span<const std::byte>(bytes));
      insert->bind(4, std::int64_t{record_checksum(n + 1, records[n].participant, bytes)});
      ASSERT_TRUE(insert->step());
    }
  }
  const auto done = branch_journal(old, copy, "copy", {"old", 30, 1, 5});
  ASSERT_TRUE(done) << describe(done.error());
  const auto copied = JournalReader::open(copy);
  EXPECT_EQ(copied->last_sequence(), 30U);
  EXPECT_EQ(copied->header().session, "copy");
  Sculpture block = Sculpture::create(session_->scene()->settings).value();
  for (std::size_t n = 0; n < 30; ++n) block.apply(*kernel_command(records[n].command)).value();
  EXPECT_EQ(replay(copy)->hash.hash, block.state_hash());
}

TEST_F(Branches, NeedAFreeIdAndACommittedRecord) {
  carve();
  EXPECT_EQ(registry_->branch("block", *session_, 5).error().code, RegistryErrorCode::kExists);
  EXPECT_EQ(registry_->branch("Bad id", *session_, 5).error().code, RegistryErrorCode::kBadId);
  const auto beyond = registry_->branch("beyond", *session_, session_->sequence() + 1);
  EXPECT_EQ(beyond.error().code, RegistryErrorCode::kDiskFails);
  EXPECT_FALSE(std::filesystem::exists(folder_->path() / "beyond.kerf"));
  EXPECT_TRUE(branch("beyond", 5));
}

TEST_F(Branches, UnfinishedFilesAreNoSessions) {
  carve();
  const auto leave_copy = [&] {
    for (const char* end : {".kerf.tmp", ".kerf.tmp-wal"}) {
      std::ofstream(folder_->path() / (std::string("other") + end)) << "half a copy";
    }
  };
  const auto is_left = [&] {
    return std::filesystem::exists(folder_->path() / "other.kerf.tmp") ||
           std::filesystem::exists(folder_->path() / "other.kerf.tmp-wal");
  };
  leave_copy();
  reload();
  EXPECT_FALSE(is_left());
  EXPECT_EQ(registry_->ids(), std::vector<std::string>{"block"});
  leave_copy();
  EXPECT_TRUE(branch("other", session_->sequence()));
  EXPECT_FALSE(is_left());
}

/// A journal with a few MB of records.
class LargeJournal : public testing::Test {
 protected:
  static constexpr int kRows = 40;
  static constexpr std::size_t kRowBytes = 100'000;
  void SetUp() override {
    auto database = test::value_of(create_journal(file_, {"large", "{}", {}}));
    auto insert = database.prepare("INSERT INTO batches VALUES(?,1,0,0,?,0)");
    const std::vector<std::byte> bytes(kRowBytes, std::byte{7});
    for (int row = 1; row <= kRows; ++row) {
      insert->bind(1, std::int64_t{row});
      insert->bind(2, std::span<const std::byte>(bytes));
      ASSERT_TRUE(insert->step());
    }
  }
  bool branch() const {
    return branch_journal(file_, copy_, "copy", {"large", kRows, 1, 5}).has_value();
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "large.kerf", copy_ = folder_.path() / "copy.kerf";
};

using LargeJournalDeathTest = LargeJournal;

TEST_F(LargeJournalDeathTest, CrashWhileBranchingLeavesNoPartialJournal) {
  // The system kills a process that enlarges a file beyond this limit.
  for (const rlim_t bytes : {rlim_t{20'000}, rlim_t{200'000}, rlim_t{kRows * kRowBytes}}) {
    const auto branch_in_vain = [&] {
      const rlimit no_core{0, 0}, limit{bytes, bytes};
      setrlimit(RLIMIT_CORE, &no_core);
      setrlimit(RLIMIT_FSIZE, &limit);
      branch();
    };
    EXPECT_EXIT(branch_in_vain(), testing::KilledBySignal(SIGXFSZ), "") << bytes;
    EXPECT_FALSE(std::filesystem::exists(copy_)) << bytes;
  }
  EXPECT_TRUE(branch());
  EXPECT_EQ(JournalReader::open(copy_)->last_sequence(), std::uint64_t{kRows});
}

TEST_F(LargeJournal, IsWrittenOnceForABranch) {
  const auto written = [] {
    std::ifstream in("/proc/self/io");
    std::string name;
    std::uint64_t bytes = 0;
    while (in >> name >> bytes && name != "wchar:") {
    }
    return bytes;
  };
  const std::uint64_t before = written();
  ASSERT_TRUE(branch());
  const std::uint64_t bytes = written() - before;
  EXPECT_GT(bytes, kRows * kRowBytes);
  EXPECT_LT(bytes, kRows * kRowBytes * 3 / 2);
  // Later records go through the log.
  auto database = open_journal(copy_, SqlMode::kWrite);
  ASSERT_TRUE(database);
  EXPECT_TRUE(std::filesystem::exists(copy_.string() + "-wal"));
  EXPECT_FALSE(std::filesystem::exists(copy_.string() + ".tmp"));
}

TEST_F(Branches, DoNotFillTheDisk) {
  carve();
  reload();  // restarts the write-ahead log, which is longer on a slow machine
  const std::uintmax_t bytes = measure_disk(folder_->path()).folder;
  session_.reset();
  registry_.emplace(
      RegistryOptions{folder_->path(), 4, {}, {}, {}, {.folder = bytes + bytes / 3}},
      [this](const std::string&) { return executor_; }, workers_);
  ASSERT_TRUE(registry_->load_all().failures.empty());
  session_ = registry_->find("block");
  registry_->keep_disk_limits();
  ASSERT_FALSE(registry_->disk_obstacle());
  EXPECT_EQ(registry_->branch("other", *session_, 5).error().code, RegistryErrorCode::kDiskFull);
}

}  // namespace
}  // namespace kerf::session_branch_test
