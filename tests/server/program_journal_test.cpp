// SPDX-License-Identifier: Apache-2.0
// Programs that are faster than the disk, and the records of their air motions.
#include <chrono>
#include <sstream>
#include <thread>

#include "server/session/replay.h"
#include "server/session/session_export.h"
#include "tests/server/session_fixture.h"
#include "tests/server/store/faulty_disk.h"

namespace kerf::program_journal_test {
namespace {

class ProgramJournal : public SessionTest {
 protected:
  void TearDown() override {
    disk.block_syncs(false);
    registry.reset();  // closes the journals before the disk goes
  }
  /// A path through `points`, with one motion of a millisecond to each point.
  static Program program_through(const std::vector<Vec3>& points) {
    Program program{.name = "path.ngc"};
    for (std::size_t n = 1; n < points.size(); ++n) {
      ProgramMotion& motion = program.motions.emplace_back();
      motion.tool = 1;
      motion.from.tip_mm = points[n - 1];
      motion.to.tip_mm = points[n];
      motion.duration_s = 0.001;
      motion.line = static_cast<std::uint32_t>(n);
    }
    return program;
  }
  /// Runs a program like the server. A disk whose syncs block is released when the program waits.
  ProgramStatus run(Session& session, Program program) {
    const auto started = session.programs().start(std::move(program), {ProgramPace::kFast});
    EXPECT_TRUE(started);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    ProgramStatus status = *started;
    while (status.state == ProgramState::kRunning && std::chrono::steady_clock::now() < end) {
      for (int n = 0; n < 1000 && executor->run_one(); ++n) {
      }
      status = *session.programs().status(started->id);
      if (status.waiting) {
        EXPECT_LT(session.journal_lag(), kJournalBufferRecords / 2) << "the rest is for agents";
        disk.block_syncs(false);
      }
      waited = waited || status.waiting;
      if (executor->waiting() > 0) continue;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      executor->run_delayed();
    }
    EXPECT_EQ(status.state, ProgramState::kFinished) << status.error;
    EXPECT_EQ(status.motions_done, status.motions);
    return status;
  }
  /// Replays the journal and expects the state of the session.
  void expect_replay_of(Session& session) {
    ASSERT_TRUE(session.flush());
    const auto replayed = replay(session.journal_file());
    ASSERT_TRUE(replayed) << describe(replayed.error());
    EXPECT_EQ(replayed->hash.hash, session.solid().hash());
    EXPECT_EQ(replayed->sculpture.motions(), session.info().motions);
    EXPECT_EQ(replayed->last_sequence, session.sequence());
  }

  test::FaultyDisk disk;
  bool waited = false;
};

/// A zigzag above the block, no two motions of which can be joined.
std::vector<Vec3> zigzag(std::size_t motions, double z_mm) {
  std::vector<Vec3> points;
  for (std::size_t n = 0; n <= motions; ++n) {
    const double y = static_cast<double>(n % 300) / 10 - 15;
    points.push_back({n % 2 == 0 ? -1.0 : 1.0, y, z_mm});
  }
  return points;
}

TEST_F(ProgramJournal, TwoHundredThousandAirMovesWaitForASlowDisk) {
  const auto session = start();
  disk.set_sync_time(std::chrono::milliseconds(50));
  disk.block_syncs(true);
  run(*session, program_through(zigzag(200'000, 5)));
  EXPECT_TRUE(waited) << "the program is faster than the disk";
  EXPECT_GE(session->sequence(), 200'000U);
  EXPECT_EQ(session->info().removed_mm3, 0);
  expect_replay_of(*session);
}

TEST_F(ProgramJournal, CuttingMovesWaitForASlowDisk) {
  const auto session = start();
  disk.set_sync_time(std::chrono::milliseconds(50));
  disk.block_syncs(true);
  run(*session, program_through(zigzag(40'000, -3)));
  EXPECT_TRUE(waited);
  EXPECT_GT(session->info().removed_mm3, 100);
  expect_replay_of(*session);
}

TEST_F(ProgramJournal, ProgramWaitsForAFullDiskAndContinues) {
  const auto session = start();
  const auto agent = join(*session);
  disk.fail({test::DiskFault::kNoSpace, test::FaultTarget::kAll, 300'000});
  const auto started =
      session->programs().start(program_through(zigzag(20'000, -3)), {ProgramPace::kFast});
  ASSERT_TRUE(started);
  while (!session->pause()) {
    if (!executor->run_one()) executor->run_delayed();
  }
  for (int n = 0; n < 100; ++n) executor->run_delayed();
  const ProgramStatus paused = *session->programs().status(started->id);
  EXPECT_EQ(paused.state, ProgramState::kRunning);
  EXPECT_TRUE(paused.waiting);
  EXPECT_LT(paused.motions_done, paused.motions);
  disk.heal();
  ASSERT_TRUE(session->flush());
  while (session->programs().status(started->id)->state == ProgramState::kRunning) {
    if (!executor->run_one()) executor->run_delayed();
  }
  EXPECT_EQ(session->programs().status(started->id)->state, ProgramState::kFinished);
  EXPECT_TRUE(move(*session, agent, 0, 0, -1).rejections.empty());
  expect_replay_of(*session);
}

/// A program sampled in steps of 0.01 mm: down into the block, along it, up, and back over it.
std::vector<Vec3> loop_over_the_block() {
  const Vec3 corners[] = {{-30, 0, 20}, {-30, 0, 5}, {-15, 0, 5}, {-15, 0, -3},
                          {15, 0, -3},  {15, 0, 5},  {30, 3, 9},  {-30, 3, 9}};
  std::vector<Vec3> points = {corners[0]};
  for (std::size_t n = 1; n < std::size(corners); ++n) {
    const Vec3 along = corners[n] - corners[n - 1];
    const auto steps = static_cast<int>(length(along) / 0.01);
    for (int i = 1; i <= steps; ++i) {
      const Vec3 at = corners[n - 1] + along * (static_cast<double>(i) / steps);
      points.push_back({std::round(at.x * 1e6) / 1e6, std::round(at.y * 1e6) / 1e6,
                        std::round(at.z * 1e6) / 1e6});
    }
  }
  return points;
}

TEST_F(ProgramJournal, JoiningAirMovesKeepsTheSolid) {
  const std::vector<Vec3> points = loop_over_the_block();
  const Program program = program_through(points);
  auto every = *Sculpture::create(parse_scene(kScene, SceneSource{})->settings);
  const Scene scene = *parse_scene(kScene, SceneSource{});
  for (const auto& [id, tool] : scene.tools) every.apply(DefineTool{id, tool.tool}).value();
  double air = 0, duration_s = 0;
  for (const ProgramMotion& motion : program.motions) {
    const MoveTool move{motion.tool, motion.from, motion.to, motion.duration_s, false};
    const double removed_mm3 = every.apply(move).value().removed_mm3;
    duration_s += motion.duration_s;
    if (removed_mm3 == 0) air += 1;
  }
  const auto session = start();
  run(*session, program);
  EXPECT_EQ(session->solid().hash(), every.state_hash());
  EXPECT_EQ(session->info().removed_mm3, every.removed_volume_mm3());
  EXPECT_LT(static_cast<double>(session->sequence()),
            static_cast<double>(points.size()) - 0.8 * air);
  expect_replay_of(*session);

  // The exported program has the same path and time, and cuts the same.
  std::stringstream text;
  ASSERT_TRUE(
      export_program(session->journal_file(), {.style = {.format = ProgramFormat::kApt}}, text));
  const auto exported = parse_program("path.apt", text.str(), scene);
  ASSERT_TRUE(exported) << to_string(exported.error());
  EXPECT_EQ(exported->motions.front().from.tip_mm, points.front());
  EXPECT_EQ(exported->motions.back().to.tip_mm, points.back());
  double exported_s = 0, path_mm = 0;
  auto again = *Sculpture::create(scene.settings);
  for (const auto& [id, tool] : scene.tools) again.apply(DefineTool{id, tool.tool}).value();
  for (std::size_t n = 0; n < exported->motions.size(); ++n) {
    const ProgramMotion& motion = exported->motions[n];
    if (n > 0) {
      EXPECT_EQ(motion.from, exported->motions[n - 1].to);
    }
    exported_s += motion.duration_s;
    path_mm += length(motion.to.tip_mm - motion.from.tip_mm);
    again.apply(MoveTool{motion.tool, motion.from, motion.to, motion.duration_s, false}).value();
  }
  EXPECT_NEAR(exported_s, duration_s, 1e-5 * duration_s);
  EXPECT_NEAR(path_mm, 15 + 15 + 8 + 30 + 8 + std::sqrt(225. + 9 + 16) + 60, 0.01);
  EXPECT_EQ(again.state_hash(), every.state_hash());
}

TEST_F(ProgramJournal, CancelledProgramKeepsItsTravelledPath) {
  const auto session = start();
  std::vector<Vec3> points;
  for (int n = 0; n <= 100'000; ++n) points.push_back({-30 + n * 0.0001, 0, 20});
  const auto started = session->programs().start(program_through(points), {ProgramPace::kFast});
  while (session->programs().status(started->id)->motions_done < 10) executor->run_one();
  const auto done = session->programs().status(started->id)->motions_done;
  ASSERT_LT(done, 100'000U);
  EXPECT_TRUE(session->programs().cancel(started->id));
  ASSERT_TRUE(session->flush());
  auto reader = JournalReader::open(session->journal_file());
  Vec3 last{};
  for (auto record = reader->next(); *record; record = reader->next()) {
    if (const auto* move = std::get_if<MoveTool>(&(*record)->command)) last = move->to.tip_mm;
  }
  EXPECT_EQ(last, points.at(done));
}

TEST_F(SessionTest, RecordsHaveStrokeAndTime) {
  const auto session = start();
  const auto ada = join(*session), bob = join(*session, "Bob");
  const auto lift = [&](ParticipantId id, double x_mm) {
    wire::MotionSample sample = next(x_mm, 0, 1);
    sample.buttons = 0;
    session->move(id, {&sample, 1});
  };
  move(*session, ada, 0, 0, -1);    // places the tool
  move(*session, ada, 0.1, 0, -1);  // record 3, after the tools
  move(*session, bob, 5, 5, -1);
  move(*session, bob, 5.1, 5, -1);  // record 4
  move(*session, ada, 0.2, 0, -1);  // record 5
  lift(ada, 0.3);
  move(*session, bob, 5.2, 5, -1);    // record 6
  move(*session, ada, 0.3, 0, -0.5);  // record 7, touches down
  move(*session, ada, 0.4, 0, -0.5);  // record 8
  ASSERT_TRUE(session->people().choose_tool(ada, 2));
  ASSERT_TRUE(session->people().choose_tool(ada, 1));
  move(*session, ada, 0.5, 0, -0.5);  // record 9
  ASSERT_TRUE(session->flush());
  auto reader = JournalReader::open(session->journal_file());
  std::vector<std::uint64_t> strokes;
  std::int64_t wall_ms = 1'700'000'000'000;
  for (auto record = reader->next(); record && *record; record = reader->next()) {
    strokes.push_back((*record)->stroke);
    EXPECT_GE((*record)->wall_ms, wall_ms);
    wall_ms = (*record)->wall_ms;
  }
  EXPECT_EQ(strokes, (std::vector<std::uint64_t>{0, 0, 3, 4, 3, 4, 7, 7, 9}));
}

}  // namespace
}  // namespace kerf::program_journal_test
