// SPDX-License-Identifier: Apache-2.0
#include "server/session/session.h"

#include "server/formats/program.h"
#include "server/session/session_export.h"
#include "server/session/session_registry.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::session_test {
namespace {

TEST_F(SessionTest, SamplesAboveTheRateLimitLeaveAGapInTheCut) {
  limits.samples_burst = 2;
  limits.samples_per_s = 4;  // no sample is regained during the first three, even on a busy machine
  restart();
  const auto session = start();
  const auto id = join(*session);
  move(*session, id, -15, 0, -3);
  const auto cut = move(*session, id, -14.9, 0, -3);
  EXPECT_GT(cut.result.removed_mm3, 0);
  const auto dropped = move(*session, id, -14.8, 5, -3);
  ASSERT_EQ(dropped.rejections.size(), 1U);
  EXPECT_EQ(dropped.rejections[0].code, wire::ErrorCode::kTooFast);
  // The rate limit recovers while the tool moves elsewhere.
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  const auto elsewhere = move(*session, id, -12, 5, -3);
  EXPECT_TRUE(elsewhere.rejections.empty());
  EXPECT_EQ(elsewhere.result.removed_mm3, 0);
  EXPECT_GT(move(*session, id, -12, 4.9, -3).result.removed_mm3, 0);
}

TEST_F(SessionTest, RejectedMotionsAreNotJournaled) {
  const auto session = start();
  const auto id = join(*session);
  move(*session, id, -15, 0, -3);
  const std::uint64_t before = session->info().sequence;
  wire::MotionSample flipped = next(-14, 0, -3);
  flipped.axis = {0, 0, -1};
  const MotionAnswer answer = session->move(id, {&flipped, 1});
  ASSERT_EQ(answer.rejections.size(), 1U);
  EXPECT_EQ(answer.rejections[0].code, wire::ErrorCode::kTurnTooLarge);
  EXPECT_EQ(session->info().sequence, before);
}

TEST_F(SessionTest, ObstaclesPushAToolThatDoesNotCut) {
  std::string scene = kScene;
  scene.insert(scene.rfind('}'), R"(, "obstacles": [{"shape": "box", "min_mm": [-20, -20, 5],
    "max_mm": [20, 20, 10], "stiffness_n_per_mm": 2}])");
  const auto session = *registry->create("post", scene, SceneSource{});
  const auto id = join(*session);
  for (const double z : {12.0, 9.5}) {
    wire::MotionSample sample = next(0, 0, z);
    sample.buttons = 0;
    const MotionAnswer answer = session->move(id, {&sample, 1});
    EXPECT_TRUE(answer.rejections.empty());
    const bool touches = z < 10;
    EXPECT_NEAR(double(answer.result.force_n.z), touches ? 2 * 0.5 : 0, 1e-3);
    EXPECT_EQ((answer.result.status & wire::kStatusColliding) != 0, touches);
  }
  EXPECT_EQ(session->info().motions, 0U);
}

TEST_F(SessionTest, AppliesMotionsAndJournalsThem) {
  const auto session = start();
  const auto id = join(*session);
  carve_circle(*session, id);
  EXPECT_EQ(session->info().motions, 200U);
  EXPECT_GT(session->info().removed_mm3, 100);
  ASSERT_TRUE(session->flush());
  auto reader = test::value_of(JournalReader::open(session->journal_file()));
  int moves = 0;
  for (;;) {
    const auto record = test::value_of(reader.next());
    if (!record.has_value()) break;
    moves += std::holds_alternative<MoveTool>(record->command) ? 1 : 0;
  }
  EXPECT_EQ(moves, 200);
  EXPECT_EQ(reader.participants().at(0).name, "Ada");
}

TEST_F(SessionTest, ReplayGivesTheSameHash) {
  const auto session = start();
  carve_circle(*session, join(*session));
  const std::uint64_t hash = session->solid().hash();
  ASSERT_TRUE(session->flush());
  const auto replayed = test::value_of(replay(session->journal_file()));
  EXPECT_EQ(replayed.hash.hash, hash);
  EXPECT_EQ(replayed.last_sequence, session->sequence());
}

TEST_F(SessionTest, ReplayOfATriDexelBlockGivesTheSameHash) {
  std::string scene = kScene;
  scene.replace(scene.find("dexel"), 5, "tri-dexel");
  const auto session = start(scene);
  carve_circle(*session, join(*session));
  const SolidSnapshot solid = session->solid();
  EXPECT_EQ(solid.fields.size(), 3U);
  ASSERT_TRUE(session->flush());
  const auto replayed = test::value_of(replay(session->journal_file()));
  EXPECT_EQ(replayed.scene.settings.rays, Rays::kTriDexel);
  EXPECT_EQ(replayed.hash.hash, solid.hash());
}

TEST_F(SessionTest, ReplayFailsIfAStateHashDiffers) {
  const auto session = start();
  carve_circle(*session, join(*session));
  session->note_hash({session->sequence(), 0xBAD});
  ASSERT_TRUE(session->flush());
  const auto error = test::error_of(replay(session->journal_file()));
  EXPECT_EQ(error.code, JournalErrorCode::kCorrupt);
  EXPECT_NE(error.reason.find("0000000000000bad"), std::string::npos);
}

TEST_F(SessionTest, RegistryRestoresSessions) {
  std::uint64_t hash = 0;
  {
    const auto session = start();
    carve_circle(*session, join(*session));
    hash = session->solid().hash();
    ASSERT_TRUE(session->flush());
  }
  restart();
  const LoadReport report = registry->load_all();
  EXPECT_TRUE(report.failures.empty());
  EXPECT_TRUE(report.recarved.empty());
  const auto session = registry->find("block");
  ASSERT_TRUE(session);
  EXPECT_EQ(session->current_hash()->hash, hash);
  EXPECT_EQ(session->epoch(), 3U);  // created, started, started again
  EXPECT_GT(join(*session), 1U);
}

/// Stores data of another kernel version: its version, and a hash that this kernel does not
/// compute.
void pretend_kernel_version(const std::filesystem::path& file, const std::string& statement) {
  auto database = test::value_of(SqlDatabase::open(file, SqlMode::kWrite));
  ASSERT_TRUE(database.execute(statement)) << statement;
  ASSERT_TRUE(database.execute("UPDATE state_hashes SET hash=2989"));
}

TEST_F(SessionTest, JournalOfAnotherKernelIsRecarvedOnceAndKeepsItsNewHash) {
  std::uint64_t hash = 0;
  std::filesystem::path file;
  for (const std::string version :
       {"UPDATE kernel_versions SET version=version-1", "UPDATE kernel_versions SET version=99",
        "DELETE FROM kernel_versions; INSERT INTO kernel_versions VALUES(0,-1)"}) {
    if (hash == 0) {
      const auto session = start();
      carve_circle(*session, join(*session));
      hash = session->solid().hash();
      session->note_hash({session->sequence(), hash});
      ASSERT_TRUE(session->flush());
      file = session->journal_file();
    }
    restart();
    pretend_kernel_version(file, version);
    const LoadReport report = registry->load_all();
    ASSERT_TRUE(report.failures.empty()) << describe(report.failures[0]);
    ASSERT_EQ(report.recarved.size(), 1U) << version;
    EXPECT_EQ(report.recarved[0].id, "block");
    EXPECT_NE(report.recarved[0].kernel_version, kKernelVersion);
    EXPECT_EQ(registry->find("block")->current_hash()->hash, hash);
    ASSERT_TRUE(registry->find("block")->flush());
    // From now on the journal belongs to this kernel.
    EXPECT_FALSE(test::value_of(replay(file)).is_recarved());
    const auto reader = JournalReader::open(file);
    EXPECT_EQ(reader->header().kernel_version, kKernelVersion);
    EXPECT_EQ(reader->state_hashes().back().hash, hash);
  }
  restart();
  EXPECT_TRUE(registry->load_all().recarved.empty());
}

TEST_F(SessionTest, WrongHashOfARecarvedJournalIsCorruption) {
  const auto session = start();
  carve_circle(*session, join(*session));
  ASSERT_TRUE(session->flush());
  const auto file = session->journal_file();
  restart();
  pretend_kernel_version(file, "UPDATE kernel_versions SET version=version-1");
  ASSERT_EQ(registry->load_all().recarved.size(), 1U);
  ASSERT_TRUE(registry->find("block")->flush());
  restart();
  pretend_kernel_version(file, "SELECT 1");
  const LoadReport report = registry->load_all();
  ASSERT_EQ(report.failures.size(), 1U);
  EXPECT_EQ(report.failures[0].code, JournalErrorCode::kCorrupt);
  EXPECT_TRUE(report.recarved.empty());
}

TEST_F(SessionTest, RejectedSampleDoesNotStopTheRestOfTheBatch) {
  const auto session = start();
  const auto id = join(*session);
  std::vector<wire::MotionSample> batch = {next(0, 0, -1), next(1, 0, -1), next(2, 0, -1),
                                           next(3, 0, -1)};
  batch[1].tool_id = 9;
  const auto answer = session->move(id, batch);
  ASSERT_EQ(answer.rejections.size(), 1U);
  EXPECT_EQ(answer.rejections[0].code, wire::ErrorCode::kUnknownTool);
  EXPECT_EQ(answer.result.status & wire::kStatusRejected, wire::kStatusRejected);
  EXPECT_EQ(session->info().motions, 2U);  // 0 to 2, the chord across the gap, and 2 to 3
}

TEST_F(SessionTest, MotionAboveTheSpeedLimitMovesTheToolWithoutCutting) {
  const auto session = start();
  const auto id = join(*session);
  move(*session, id, 0, 0, 5);
  const auto jump = move(*session, id, 0, 0, -15);
  ASSERT_EQ(jump.rejections.size(), 1U);
  EXPECT_EQ(jump.rejections[0].code, wire::ErrorCode::kTooFast);
  EXPECT_EQ(session->info().motions, 0U);
  EXPECT_TRUE(move(*session, id, 0.5, 0, -15).rejections.empty());
  EXPECT_EQ(session->info().motions, 1U);
}

TEST_F(SessionTest, ChangedTilesAreReportedOnce) {
  const auto session = start();
  const auto id = join(*session);
  move(*session, id, 0, 0, -1);
  move(*session, id, 1, 0, -1);
  const auto frame = session->frame(false);
  EXPECT_FALSE(frame.changed.empty());
  EXPECT_TRUE(frame.snapshot);
  ASSERT_EQ(frame.tools.tools.size(), 1U);
  EXPECT_EQ(frame.tools.tools[0].tip_mm.x, 1.0);
  const auto again = session->frame(false);
  EXPECT_TRUE(again.changed.empty());
  EXPECT_FALSE(again.snapshot);
}

TEST_F(SessionTest, HashIsComputedByTheWorkersAfterAChange) {
  const auto session = start();
  const auto id = join(*session);
  move(*session, id, 0, 0, -1);
  move(*session, id, 1, 0, -1);
  EXPECT_FALSE(session->current_hash());
  executor->run_delayed();
  workers.run();
  executor->run();
  ASSERT_TRUE(session->current_hash());
  EXPECT_EQ(session->current_hash()->hash, session->solid().hash());
}

TEST_F(SessionTest, AgentsAreServedBetweenProgramSlices) {
  const auto session = start();
  const auto id = join(*session);
  std::string text = "G21 G90 T2 M6\n";
  for (int i = 0; i < 3000; ++i) text += "G1 X" + std::to_string(i % 30) + " Y0 Z-1 F1000\n";
  const auto program = test::value_of(parse_program("long.ngc", text + "M2\n", *session->scene()));
  const auto run = test::value_of(session->programs().start(program, {ProgramPace::kFast}));
  executor->run_one();
  EXPECT_EQ(session->programs().status(run.id)->state, ProgramState::kRunning);
  EXPECT_LE(executor->waiting(), 2U);  // the next slice runs after work that agents post now
  move(*session, id, 0, 0, -1);
  EXPECT_GT(move(*session, id, 0, 1, -1).result.motions_applied, 0U);
  executor->run_one();
  EXPECT_EQ(executor->waiting(), 0U);  // an agent is moving: the next slice waits for a pause
  EXPECT_GE(executor->last_delay.count(), 200);
  while (session->programs().status(run.id)->state == ProgramState::kRunning)
    executor->run_delayed();
  EXPECT_EQ(session->programs().status(run.id)->state, ProgramState::kFinished);
  EXPECT_EQ(session->participants().size(), 1U);
}

TEST_F(SessionTest, ProgramWithUnknownToolCutsNothing) {
  const auto session = start();
  Program program{.name = "x.ngc"};
  program.motions.resize(1);
  program.motions[0].tool = 9;
  program.motions[0].line = 4;
  const auto error = test::error_of(session->programs().start(program, {ProgramPace::kFast}));
  EXPECT_EQ(error.code, wire::ErrorCode::kUnknownTool);
  EXPECT_NE(error.reason.find("x.ngc:4"), std::string::npos);
}

TEST_F(SessionTest, ExportedProgramCarvesTheSameSolid) {
  const auto session = start();
  const auto ada = join(*session, "Ada");
  const auto grace = join(*session, "Grace");
  carve_circle(*session, ada);
  sequence = 0;
  for (int i = 0; i < 100; ++i) move(*session, grace, -15 + 0.2 * i, 3 + std::sin(0.1 * i), -2);
  ASSERT_TRUE(session->flush());
  for (const auto format : {ProgramFormat::kGcode, ProgramFormat::kApt}) {
    std::stringstream text;
    ASSERT_TRUE(export_program(session->journal_file(), {.style = {.format = format}}, text));
    const auto program = test::value_of(parse_program(
        format == ProgramFormat::kApt ? "x.apt" : "x.ngc", text.str(), *session->scene()));
    const auto other = test::value_of(registry->create("", kScene, SceneSource{}));
    ASSERT_TRUE(other->programs().start(program, {ProgramPace::kFast}));
    executor->run();
    EXPECT_EQ(other->solid().hash(), session->solid().hash());
  }
}

TEST_F(SessionTest, ExportedForcesEqualTheForcesSent) {
  const auto session = start();
  const auto id = join(*session);
  move(*session, id, -10, 0, -2);
  const auto felt = move(*session, id, -9, 0, -2);
  ASSERT_TRUE(session->flush());
  std::stringstream csv;
  ASSERT_TRUE(export_forces(session->journal_file(), {}, csv));
  std::string head, line;
  std::getline(csv, head);
  std::getline(csv, line);
  std::vector<double> numbers;
  std::stringstream fields(line);
  for (std::string field; std::getline(fields, field, ',');) numbers.push_back(std::stod(field));
  ASSERT_EQ(numbers.size(), 15U);
  EXPECT_NEAR(numbers[7], static_cast<double>(felt.result.force_n.x), 1e-5);
  EXPECT_NEAR(numbers[13], static_cast<double>(felt.result.removed_mm3), 1e-5);
  EXPECT_LT(numbers[7], 0);
}

TEST_F(SessionTest, ExceededLimitsGiveTypedRejections) {
  limits.agents_max = 2;
  restart();
  const auto session = start();
  join(*session);
  join(*session);
  const auto error = test::error_of(session->join({ParticipantKind::kAgent, "Third", "", 1, true}));
  EXPECT_EQ(error.code, wire::ErrorCode::kBusy);
  const auto named =
      test::error_of(session->join({ParticipantKind::kViewer, std::string(65, 'x'), "", 0, true}));
  EXPECT_EQ(named.code, wire::ErrorCode::kTooLarge);
}

TEST_F(SessionTest, ClosedSessionAppliesNothing) {
  const auto session = start();
  const auto id = join(*session);
  move(*session, id, 0, 0, -1);
  std::string reason;
  session->listen([&](const SessionEvent& event) { reason = event.closing; });
  session->close("enough");
  EXPECT_EQ(reason, "enough");
  EXPECT_FALSE(move(*session, id, 1, 0, -1).rejections.empty());
  EXPECT_EQ(session->info().motions, 0U);
  EXPECT_FALSE(session->join({ParticipantKind::kAgent, "Late", "", 1, true}));
}

TEST_F(SessionTest, BlockWithTooManyTilesIsRejected) {
  std::string scene = kScene;
  scene.replace(scene.find("0.5"), 3, "0.001");
  const auto error = test::error_of(registry->create("fine", scene, SceneSource{}));
  EXPECT_EQ(error.code, RegistryErrorCode::kBadScene);
  EXPECT_EQ(error.path, "accuracy.pitch_mm");
  EXPECT_NE(error.reason.find("1562500 tiles"), std::string::npos);
}

TEST_F(SessionTest, RegistryDerivesIdsAndLimitsTheNumberOfSessions) {
  EXPECT_EQ((*registry->create("", kScene, SceneSource{}))->id(), "test-block");
  EXPECT_EQ((*registry->create("", kScene, SceneSource{}))->id(), "test-block-2");
  const auto error = test::error_of(registry->create("", "{\"name\": 1}", SceneSource{}));
  EXPECT_EQ(error.code, RegistryErrorCode::kBadScene);
  EXPECT_TRUE(registry->create("three", kScene, SceneSource{}));
  EXPECT_TRUE(registry->create("four", kScene, SceneSource{}));
  const auto fifth = test::error_of(registry->create("five", kScene, SceneSource{}));
  EXPECT_EQ(fifth.code, RegistryErrorCode::kTooMany);
  EXPECT_EQ(registry->list().size(), 4U);
}

}  // namespace
}  // namespace kerf::session_test
