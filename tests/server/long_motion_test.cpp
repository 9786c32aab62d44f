// SPDX-License-Identifier: Apache-2.0
// Motions that are more work than one turn of a session's executor.
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::long_motion_test {
namespace {

/// 25 x 25 tiles, and a mill that covers all of them.
constexpr const char* kWideScene = R"({
  "name": "Wide",
  "stock": {"shape": "box", "min_mm": [-40, -40, -5], "max_mm": [40, 40, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.1, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "flat", "diameter_mm": 200, "length_mm": 60},
            {"id": 2, "shape": "ball", "diameter_mm": 10, "length_mm": 60}],
  "machine": {"kinematics": "tool-vector"}})";

class LongMotionTest : public SessionTest {
 protected:
  void SetUp() override {
    SessionTest::SetUp();
    session = start(kWideScene);
    mill = join(*session, "Mill");
    ball = join(*session, "Ball");
  }
  wire::MotionSample with_ball(double x_mm, double z_mm) {
    wire::MotionSample sample = next(x_mm, 0, z_mm);
    sample.tool_id = 2;
    return sample;
  }
  /// Replays the journal and returns the hash.
  std::uint64_t replayed_hash() {
    EXPECT_TRUE(session->flush());
    const auto replayed = replay(session->journal_file());
    EXPECT_TRUE(replayed);
    return replayed->hash.hash;
  }
  /// Begins a plunge of the mill by 2 mm. Its end is sent with the first sample.
  std::optional<MotionAnswer> plunge() {
    const std::array samples = {next(0, 0, 1), next(0, 0, -2)};
    return session->begin_move(mill, samples);
  }

  std::shared_ptr<Session> session;
  ParticipantId mill = 0, ball = 0;
};

TEST_F(LongMotionTest, TakesSeveralTurnsSharedWithOtherParticipants) {
  ASSERT_FALSE(plunge());
  EXPECT_TRUE(session->is_between_records());
  std::optional<MotionAnswer> answer;
  int turns = 0;
  double x_mm = -30;
  while (!answer) {
    const wire::MotionSample sample = with_ball(x_mm += 0.5, -3);
    EXPECT_TRUE(session->begin_move(ball, {&sample, 1})) << "a short motion takes one turn";
    answer = session->go_on(mill);
    ++turns;
  }
  EXPECT_GE(turns, 4);
  EXPECT_FALSE(session->is_between_records());
  EXPECT_TRUE(answer->rejections.empty());
  EXPECT_GT(answer->result.removed_mm3, 10'000);
  EXPECT_EQ(session->solid().hash(), replayed_hash());
}

TEST_F(LongMotionTest, EqualsTheMotionInOneTurnToTheBit) {
  const std::array samples = {next(0, 0, 1), next(0, 0, -2)};
  const MotionAnswer answer = session->move(mill, samples);
  EXPECT_EQ(answer.result.agent_sequence, samples[1].agent_sequence);
  EXPECT_FLOAT_EQ(answer.result.removed_mm3, 80 * 80 * 2);
  EXPECT_EQ(session->solid().hash(), replayed_hash());
}

TEST_F(LongMotionTest, IsCompletedWhenItsParticipantLeaves) {
  ASSERT_FALSE(plunge());
  session->leave(mill);
  EXPECT_TRUE(session->is_between_records());
  executor->run();
  EXPECT_FALSE(session->is_between_records());
  EXPECT_NEAR(session->info().removed_mm3, 80 * 80 * 2, 1e-6);
  EXPECT_EQ(session->solid().hash(), replayed_hash());
}

TEST_F(LongMotionTest, ResumedParticipantGetsThePendingMotionInItsNextResult) {
  JoinRequest request{
      .kind = ParticipantKind::kAgent, .name = "", .color = "", .tool = 1, .durable = true};
  const auto admission = test::value_of(session->admit(request));
  mill = admission.participant.id;
  ASSERT_FALSE(plunge());
  session->leave(mill);
  request.token = admission.token;
  ASSERT_TRUE(session->admit(request)->resumed);
  const wire::MotionSample sample = next(0, 0, -2);
  ASSERT_FALSE(session->begin_move(mill, {&sample, 1}));
  executor->run();
  std::optional<MotionAnswer> answer;
  while (!answer) answer = session->go_on(mill);
  EXPECT_GT(answer->result.removed_mm3, 1000);
  EXPECT_NEAR(session->info().removed_mm3, 80 * 80 * 2, 1e-6);
  EXPECT_EQ(session->solid().hash(), replayed_hash());
}

TEST_F(LongMotionTest, ProgramMotionTakesSeveralSlicesAndSurvivesCancellation) {
  Program program{.name = "wide.ngc"};
  program.motions.resize(2);
  for (ProgramMotion& motion : program.motions) motion.tool = 1;
  program.motions[0].from.tip_mm = program.motions[1].to.tip_mm = {0, 0, 1};
  program.motions[0].to.tip_mm = program.motions[1].from.tip_mm = {0, 0, -2};
  const auto run = test::value_of(session->programs().start(program, {ProgramPace::kFast}));
  ASSERT_TRUE(executor->run_one());
  if (session->programs().status(run.id)->state == ProgramState::kRunning) {
    EXPECT_TRUE(session->programs().cancel(run.id));
  }
  executor->run();
  executor->run_delayed();
  EXPECT_FALSE(session->is_between_records());
  EXPECT_NEAR(session->info().removed_mm3, 80 * 80 * 2, 1e-6);
  EXPECT_EQ(session->solid().hash(), replayed_hash());
}

TEST_F(LongMotionTest, NoHashIsJournaledWhileItIsIncomplete) {
  ASSERT_FALSE(plunge());
  executor->run_delayed();
  workers.run();
  executor->run();
  EXPECT_FALSE(session->current_hash());
  while (!session->go_on(mill)) {
  }
  executor->run_delayed();
  workers.run();
  executor->run();
  ASSERT_TRUE(session->current_hash());
  EXPECT_EQ(session->current_hash()->hash, session->solid().hash());
  EXPECT_EQ(replayed_hash(), session->solid().hash());
}

TEST_F(LongMotionTest, LargeBatchContinuesInLaterTurns) {
  std::vector<wire::MotionSample> samples;
  for (int n = 0; n < 16; ++n) {
    wire::MotionSample sample = with_ball(-38 + 5 * n, -3);
    sample.tip_mm.y = n % 2 == 0 ? -38 : 38;  // about 75 tiles each
    sample.time_us = 100'000 * static_cast<std::uint64_t>(n + 1);
    samples.push_back(sample);
  }
  auto answer = session->begin_move(ball, samples);
  ASSERT_FALSE(answer);
  while (!answer) answer = session->go_on(ball);
  EXPECT_TRUE(answer->rejections.empty());
  EXPECT_EQ(answer->result.agent_sequence, samples.back().agent_sequence);
  EXPECT_EQ(session->info().motions, 15U);
  EXPECT_EQ(session->solid().hash(), replayed_hash());
}

}  // namespace
}  // namespace kerf::long_motion_test
