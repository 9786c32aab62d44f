// SPDX-License-Identifier: Apache-2.0
// Sessions that are restored from a snapshot and the records after it.
#include <algorithm>
#include <fstream>
#include <random>

#include "server/formats/pose_grid.h"
#include "server/session/replay.h"
#include "server/store/block_snapshot.h"
#include "tests/server/session_fixture.h"

namespace kerf::session_snapshot_test {
namespace {

/// Runs work at once on the posting thread, and never runs delayed work.
class AtOnce final : public Executor {
 public:
  void post(Work work) override { work(); }
  void post_after(std::chrono::microseconds, Work) override {}
};

class SessionSnapshots : public SessionTest {
 protected:
  void SetUp() override {
    snapshots.writer = &writer;
    snapshots.limits = {.replay_time = {}, .age = std::chrono::hours(1), .pause = {}};
    snapshots.on_failure = [](const std::string&, const std::string& reason) {
      ADD_FAILURE() << reason;
    };
    SessionTest::SetUp();
  }
  std::filesystem::path journal() const { return folder / "block.kerf"; }
  /// Writes the snapshot if one is due.
  void write_due() {
    writer.run();
    executor->run();
  }
  /// Leaves a closed journal of `motions` motions, with a snapshot in the middle.
  void leave(int motions, const std::string& scene = kScene) {
    const auto session = start(scene);
    const auto id = join(*session);
    sequence = 0;
    for (int n = 0; n <= motions; ++n) {
      move(*session, id, 0.05 * n, 0.02 * n, -1 - 0.01 * n);
      if (n == motions / 2) write_due();
    }
    ASSERT_TRUE(session->flush());
    registry.reset();
    writer = {};
  }

  test::ManualExecutor writer;
};

/// Compares two sessions restored from one journal.
void expect_equal(Replayed& found, Replayed& expected) {
  EXPECT_EQ(found.last_sequence, expected.last_sequence);
  EXPECT_EQ(found.hash.sequence, expected.hash.sequence);
  EXPECT_EQ(found.hash.hash, expected.hash.hash);
  EXPECT_EQ(found.last_participant, expected.last_participant);
  EXPECT_EQ(found.dropped_hashes, expected.dropped_hashes);
  EXPECT_EQ(found.sculpture.motions(), expected.sculpture.motions());
  EXPECT_EQ(found.sculpture.sub_motions(), expected.sculpture.sub_motions());
  EXPECT_EQ(found.sculpture.removed_volume_mm3(), expected.sculpture.removed_volume_mm3());
  EXPECT_EQ(found.sculpture.imprint_volume_mm3(), expected.sculpture.imprint_volume_mm3());
  for (ParticipantId id = 0; id < expected.last_participant + 2; ++id) {
    const ResumableAgent *a = found.resumable.find(id), *b = expected.resumable.find(id);
    ASSERT_EQ(a == nullptr, b == nullptr) << id;
    if (a == nullptr) continue;
    EXPECT_EQ(a->last_sequence, b->last_sequence);
    EXPECT_EQ(a->in_stroke, b->in_stroke);
    EXPECT_EQ(a->token, b->token);
  }
}

/// Three agents and fast programs on one block, at random.
class Crowd {
 public:
  Crowd(Session& session, unsigned seed) : session_(session), random_(seed) {
    for (int n = 0; n < 3; ++n) {
      const auto joined = session.admit({.kind = ParticipantKind::kAgent,
                                         .name = "agent",
                                         .color = "",
                                         .tool = static_cast<ToolId>(1 + n % 2),
                                         .feel = n != 1,
                                         .durable = n != 2});
      EXPECT_TRUE(joined);
      agents_.push_back({joined->participant.id, place()});
    }
  }
  void step() {
    Agent& agent = agents_[random_() % agents_.size()];
    if (random_() % 60 == 0) (void)session_.programs().start(program(), {ProgramPace::kFast});
    std::vector<wire::MotionSample> batch(1 + random_() % 16);
    for (wire::MotionSample& sample : batch) {
      agent.at = agent.at + (place() - agent.at) * 0.02;
      sample.agent_sequence = ++agent.sequence;
      sample.time_us = 1000 * agent.sequence;
      sample.tip_mm = agent.at;
      sample.tool_id = static_cast<std::uint32_t>(1 + (random_() % 40 == 0 ? 1 : agent.id % 2));
      sample.buttons = random_() % 30 == 0 ? 0 : wire::kButtonCutting;
    }
    session_.move(agent.id, batch);
  }

 private:
  struct Agent {
    ParticipantId id = 0;
    Vec3 at;
    std::uint64_t sequence = 0;
  };
  Vec3 place() {
    std::uniform_real_distribution<double> side(-22, 22), depth(-15, 5);
    return {side(random_), side(random_), depth(random_)};
  }
  /// Cuts, and air motions that are joined.
  Program program() {
    Program program{.name = "path.ngc"};
    ToolPose at{admit_pose({place(), {0, 0, 1}})};
    for (int n = 0; n < 12; ++n) {
      Vec3 tip = n % 6 < 3 ? place() : at.tip_mm + Vec3{1, 0, 0};
      if (n % 6 == 2) tip.z = 5;
      const ToolPose to = admit_pose({tip, {0, 0, 1}});
      program.motions.push_back({1, at, to, 0.1, static_cast<std::uint32_t>(n + 1)});
      at = to;
    }
    return program;
  }

  Session& session_;
  std::mt19937 random_;
  std::vector<Agent> agents_;
};

TEST_F(SessionSnapshots, RestoredBlockEqualsAFullReplay) {
  const auto cut = folder / "cut.kerf";
  int restored_from_one = 0, ends = 0;
  limits.speed_mm_per_s = limits.samples_per_s = limits.samples_burst = 1e12;
  std::string tri_dexel = kScene;
  tri_dexel.replace(tri_dexel.find("dexel"), 5, "tri-dexel");
  for (const unsigned seed : {1U, 2U, 3U}) {
    restart();
    const auto session =
        *registry->create("s" + std::to_string(seed), seed == 3 ? tri_dexel : kScene, {});
    Crowd crowd(*session, seed);
    std::mt19937 random(seed);
    for (int n = 0; n < 250; ++n) {
      crowd.step();
      for (int turns = 0; turns < 4 && executor->run_one(); ++turns) {
      }
      if (random() % 40 == 0) write_due();
      if (random() % 30 != 0) continue;
      // The server is killed here.
      ASSERT_TRUE(session->flush());
      ASSERT_TRUE(copy_journal(session->journal_file(), cut));
      std::error_code none_yet;
      std::filesystem::copy_file(snapshot_file(session->journal_file()), snapshot_file(cut),
                                 std::filesystem::copy_options::overwrite_existing, none_yet);
      auto restored = restore(cut), expected = replay(cut);
      ASSERT_TRUE(restored && expected) << describe(expected.error());
      EXPECT_EQ(restored->snapshot_fault, "");
      expect_equal(*restored, *expected);
      // Both continue in the same manner.
      const MoveTool move{1, {{-9, 1, -2}, {0, 0, 1}}, {{9, -3, -4}, {0, 0, 1}}, 0.1, false};
      for (const MoveTool& next : {move, MoveTool{1, move.to, move.from, 0.1, false}}) {
        const auto a = restored->sculpture.apply(next), b = expected->sculpture.apply(next);
        EXPECT_EQ(a->removed_mm3, b->removed_mm3);
        EXPECT_EQ(a->imprint_mm3, b->imprint_mm3);
      }
      EXPECT_EQ(restored->sculpture.state_hash(), expected->sculpture.state_hash());
      restored_from_one += restored->snapshot_sequence > 0 ? 1 : 0;
      ++ends;
      remove_journal(cut);
    }
    session->close("");
  }
  EXPECT_GT(restored_from_one, 8);
  EXPECT_GT(ends, restored_from_one);
}

TEST_F(SessionSnapshots, ReadingFromAnyRecordGivesTheRecordsOfAFullReading) {
  leave(900);
  std::vector<JournalRecord> all;
  auto reader = JournalReader::open(journal());
  for (auto record = reader->next(); record && *record; record = reader->next()) {
    all.push_back(**record);
  }
  ASSERT_GT(all.size(), 900U);
  for (std::uint64_t from = 1; from <= all.size() + 1; from += 1 + from / 7) {
    auto part = JournalReader::open(journal(), RecordOrder::kSequence, {}, from);
    ASSERT_TRUE(part);
    for (std::uint64_t n = from; n <= all.size(); ++n) {
      const auto record = part->next();
      ASSERT_TRUE(record && *record) << from << ": " << n;
      EXPECT_EQ((*record)->sequence, n);
      EXPECT_EQ(encode_command((*record)->command), encode_command(all[n - 1].command));
    }
    const auto end = part->next();
    EXPECT_TRUE(end && !*end);
  }
}

TEST_F(SessionSnapshots, MismatchedSnapshotIsIgnoredAndNamed) {
  leave(200);
  const auto expected = replay(journal());
  const auto file = snapshot_file(journal());
  const auto expect_ignored = [&](const std::string& why) {
    auto restored = restore(journal());
    ASSERT_TRUE(restored);
    EXPECT_EQ(restored->snapshot_sequence, 0U);
    EXPECT_NE(restored->snapshot_fault.find(why), std::string::npos) << restored->snapshot_fault;
    EXPECT_EQ(restored->hash.hash, expected->hash.hash);
    restart();
    const LoadReport report = registry->load_all();
    ASSERT_EQ(report.ignored.size(), 1U) << why;
    EXPECT_EQ(report.ignored[0].reason, restored->snapshot_fault);
    EXPECT_EQ(registry->find("block")->current_hash()->hash, expected->hash.hash);
    registry.reset();
    writer = {};
  };
  ASSERT_EQ(restore(journal())->snapshot_fault, "");
  ASSERT_GT(restore(journal())->snapshot_sequence, 0U);
  const auto good = folder / "good";
  std::filesystem::copy_file(file, good);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
  expect_ignored("truncated");
  std::ofstream(file) << "nonsense";
  expect_ignored("not a snapshot");
  // A snapshot written when the block was different.
  Sculpture block = Sculpture::create(expected->scene.settings).value();
  const auto head = read_snapshot_head(good);
  SnapshotHead other = *head;
  other.hash = block.state_hash();
  ASSERT_TRUE(write_snapshot(file, other, block.state()));
  EXPECT_FALSE(restore(journal())->snapshot_fault.empty());
  other = *head;
  other.mark ^= 1;
  ASSERT_TRUE(write_snapshot(file, other, block.state()));
  expect_ignored("another journal");
  other.sequence = 9999;
  ASSERT_TRUE(write_snapshot(file, other, block.state()));
  expect_ignored("records that the journal does not have");
}

TEST_F(SessionSnapshots, PreviousSnapshotReplacesADamagedOne) {
  const auto session = start();
  const auto id = join(*session);
  for (int n = 0; n <= 300; ++n) {
    move(*session, id, 0.05 * n, 0.02 * n, -1 - 0.01 * n);
    if (n % 100 == 50) write_due();
  }
  ASSERT_TRUE(session->flush());
  registry.reset();
  writer = {};
  const auto expected = replay(journal());
  const auto newest = snapshot_file(journal()), previous = previous_snapshot_file(journal());
  const std::uint64_t last = read_snapshot_head(newest)->sequence;
  const std::uint64_t before = read_snapshot_head(previous)->sequence;
  EXPECT_EQ(last, before + 100) << "two are kept, the older one is gone";
  const auto expect_restored_from = [&](std::uint64_t from, const std::string& fault) {
    auto restored = restore(journal());
    ASSERT_TRUE(restored);
    EXPECT_EQ(restored->snapshot_sequence, from);
    EXPECT_EQ(restored->snapshot_fault, fault);
    EXPECT_EQ(restored->hash.hash, expected->hash.hash);
    EXPECT_EQ(restored->sculpture.motions(), expected->sculpture.motions());
  };
  expect_restored_from(last, "");
  std::filesystem::resize_file(newest, std::filesystem::file_size(newest) - 1);
  expect_restored_from(before, "it is truncated");

  // The next snapshot replaces the damaged one, and the good one stays.
  restart();
  const LoadReport report = registry->load_all();
  ASSERT_EQ(report.ignored.size(), 1U);
  EXPECT_EQ(report.ignored[0].used_sequence, before);
  const auto again = registry->find("block");
  carve_circle(*again, join(*again), 20);
  write_due();
  ASSERT_TRUE(again->flush());
  registry.reset();
  EXPECT_EQ(read_snapshot_head(previous)->sequence, before);
  EXPECT_GT(restore(journal())->snapshot_sequence, last);

  std::filesystem::remove(newest);
  EXPECT_EQ(restore(journal())->snapshot_sequence, before);
  EXPECT_EQ(restore(journal())->snapshot_fault, "");
  std::ofstream(newest) << "nonsense";
  std::ofstream(previous) << "nonsense";
  const auto replayed = restore(journal());
  EXPECT_EQ(replayed->snapshot_sequence, 0U);
  EXPECT_EQ(replayed->snapshot_fault,
            "it is not a snapshot of Kerf; the one before it: it is not a snapshot of Kerf");
}

TEST_F(SessionSnapshots, FirstSnapshotAfterAFullReplayRemovesTheOlderOne) {
  leave(200);
  std::ofstream(snapshot_file(journal())) << "of another version";
  std::ofstream(previous_snapshot_file(journal())) << "of another version";
  restart();
  registry->load_all();
  const auto session = registry->find("block");
  carve_circle(*session, join(*session), 20);
  write_due();
  EXPECT_GT(read_snapshot_head(snapshot_file(journal()))->sequence, 200U);
  EXPECT_FALSE(std::filesystem::exists(previous_snapshot_file(journal())));
}

TEST_F(SessionSnapshots, TheSnapshotOfAnEarlierSessionOfThatNameIsIgnored) {
  leave(200);
  std::filesystem::rename(snapshot_file(journal()), folder / "old");
  remove_journal(journal());
  restart();
  leave(200);  // the same motions, at another time
  std::filesystem::rename(folder / "old", snapshot_file(journal()));
  const auto restored = restore(journal());
  ASSERT_TRUE(restored);
  EXPECT_EQ(restored->snapshot_fault, "it is of another journal");
}

TEST_F(SessionSnapshots, SnapshotMovesWithTheClosedJournal) {
  const auto at_once = std::make_shared<AtOnce>();
  for (const bool purge : {false, true}) {
    snapshots.writer = at_once.get();
    registry.emplace(
        RegistryOptions{folder.path(), 4, limits, {}, snapshots},
        [&](const std::string&) { return at_once; }, workers);
    const auto session = start();
    sequence = 0;
    carve_circle(*session, join(*session), 20);
    EXPECT_TRUE(std::filesystem::exists(snapshot_file(journal())));
    EXPECT_TRUE(std::filesystem::exists(previous_snapshot_file(journal())));
    EXPECT_TRUE(registry->close("block", purge));
    EXPECT_FALSE(std::filesystem::exists(snapshot_file(journal())));
    EXPECT_FALSE(std::filesystem::exists(previous_snapshot_file(journal())));
    EXPECT_FALSE(std::filesystem::exists(journal()));
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder / "closed")) {
    if (entry.path().extension() != ".kerf") continue;
    EXPECT_GT(restore(entry.path())->snapshot_sequence, 0U);
    EXPECT_TRUE(std::filesystem::exists(previous_snapshot_file(entry.path())));
  }
}

TEST_F(SessionSnapshots, EndingServerWritesALastSnapshot) {
  const auto at_once = std::make_shared<AtOnce>();
  snapshots.limits.pause = std::chrono::hours(1);  // none but the first and the last
  restart();
  registry.emplace(
      RegistryOptions{folder.path(), 4, limits, {}, snapshots},
      [&](const std::string&) { return at_once; }, workers);
  const auto session = start();
  carve_circle(*session, join(*session), 50);
  const std::uint64_t last = session->sequence();
  EXPECT_TRUE(registry->close_all("").empty());
  const auto restored = restore(journal());
  ASSERT_TRUE(restored);
  EXPECT_EQ(restored->snapshot_sequence, last);
  EXPECT_EQ(restored->hash.hash, replay(journal())->hash.hash);
}

}  // namespace
}  // namespace kerf::session_snapshot_test
