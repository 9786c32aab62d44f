// SPDX-License-Identifier: Apache-2.0
#include "server/session/program_alarms.h"

#include <nlohmann/json.hpp>

#include "server/session/program_json.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::program_alarms_test {
namespace {

ProgramMotion motion_at(std::uint32_t line, double x_mm, bool rapid = false) {
  return ProgramMotion{
      .tool = 1, .to = {.tip_mm = {x_mm, 0, 0}}, .duration_s = 1, .line = line, .rapid = rapid};
}

TEST(ProgramAlarms, ConsecutiveMotionsAreOneAlarm) {
  ProgramAlarms alarms;
  alarms.follow(motion_at(3, 1), {.stock_contact_mm = 0.2});
  alarms.follow(motion_at(4, 2), {.stock_contact_mm = 0.7});
  alarms.follow(motion_at(5, 3), {.stock_contact_mm = 0.1});
  alarms.follow(motion_at(6, 4), {});
  alarms.follow(motion_at(7, 5), {.stock_contact_mm = 0.3});
  ASSERT_EQ(alarms.count(), 2U);
  const ProgramAlarm& first = alarms.list()[0];
  EXPECT_EQ(first.kind, AlarmKind::kShank);
  EXPECT_EQ(first.from_line, 3U);
  EXPECT_EQ(first.to_line, 5U);
  EXPECT_EQ(first.amount, 0.7);
  EXPECT_EQ(first.tip_mm, (Vec3{2, 0, 0}));
  EXPECT_EQ(alarms.list()[1].from_line, 7U);
}

TEST(ProgramAlarms, OnlyRapidsDeeperThanTheToleranceCount) {
  ProgramAlarms alarms({.tolerance_mm = 0.03});
  alarms.follow(motion_at(1, 1, true), {.removed_mm3 = 90, .depth_mm = 0.03});
  alarms.follow(motion_at(2, 2, false), {.removed_mm3 = 8});
  EXPECT_EQ(alarms.count(), 0U);
  alarms.follow(motion_at(3, 3, true), {.removed_mm3 = 2, .depth_mm = 0.04});
  alarms.follow(motion_at(4, 4, true), {.removed_mm3 = 3, .depth_mm = 0.5});
  ASSERT_EQ(alarms.count(), 1U);
  EXPECT_EQ(alarms.list()[0].kind, AlarmKind::kRapid);
  EXPECT_EQ(alarms.list()[0].amount, 0.5);
  EXPECT_EQ(alarms.list()[0].limit, 0.03);
  EXPECT_EQ(alarms.list()[0].removed_mm3, 5);
  EXPECT_EQ(alarms.list()[0].tip_mm.x, 4);
  ProgramAlarms fine({.tolerance_mm = 0.001});
  fine.follow(motion_at(1, 1, true), {.removed_mm3 = 90, .depth_mm = 0.019});
  EXPECT_EQ(fine.count(), 0U) << "programs are rounded";
}

TEST(ProgramAlarms, ForcesCountAboveTheLimitAndPushesWithoutStock) {
  ProgramAlarms none, limited({.force_n = 5.0});
  for (ProgramAlarms* alarms : {&none, &limited}) {
    alarms->follow(motion_at(1, 1), {.cutting_n = 5});
    alarms->follow(motion_at(2, 2), {.cutting_n = 5.1});
    alarms->follow(motion_at(3, 3), {.stock_contact_mm = 1});
    alarms->follow(motion_at(4, 4), {.collision_n = 9});
  }
  ASSERT_EQ(none.count(), 2U);
  EXPECT_EQ(none.list()[1].kind, AlarmKind::kObstacle);
  EXPECT_EQ(none.list()[1].from_line, 4U);
  ASSERT_EQ(limited.count(), 3U);
  EXPECT_EQ(limited.list()[0].kind, AlarmKind::kForce);
  EXPECT_EQ(limited.list()[0].from_line, 2U);
}

TEST(ProgramAlarms, ShankAndHolderMayBeAsDeepAsTheTolerance) {
  ProgramAlarms alarms({.tolerance_mm = 0.01});
  alarms.follow(motion_at(1, 1), {.stock_contact_mm = 0.01});
  EXPECT_EQ(alarms.count(), 0U);
  alarms.follow(motion_at(2, 2), {.stock_contact_mm = 0.011});
  EXPECT_EQ(alarms.count(), 1U);
}

/// The columns of a groove are farther apart than the ends of the samples along it.
TEST(ProgramAlarms, GougesWithinTwoPitchesOfPathAreOne) {
  ProgramAlarms alarms({.pitch_mm = 0.5});
  const auto follow = [&](std::uint32_t line, double from_x, double depth_mm) {
    ProgramMotion motion = motion_at(line, from_x + 0.4);
    motion.from.tip_mm = {from_x, 0, 0};
    CarvedMotion carved{.removed_mm3 = 1};
    if (depth_mm > 0) carved.gouge = Gouge{depth_mm, {from_x, 0, -depth_mm}};
    alarms.follow(motion, carved);
  };
  follow(3, 0, 0.2);
  follow(3, 0.4, 0);
  follow(4, 0.8, 0);
  follow(4, 1.2, 0.6);
  follow(5, 1.6, 0.3);
  ASSERT_EQ(alarms.count(), 1U);
  const ProgramAlarm& first = alarms.list()[0];
  EXPECT_EQ(first.kind, AlarmKind::kGouge);
  EXPECT_EQ(first.from_line, 3U);
  EXPECT_EQ(first.to_line, 5U);
  EXPECT_EQ(first.amount, 0.6);
  EXPECT_EQ(first.at_mm, (Vec3{1.2, 0, -0.6}));
  for (const double x : {2.0, 2.4, 2.8}) follow(6, x, 0);
  follow(6, 3.2, 0.2);
  ASSERT_EQ(alarms.count(), 2U);
  EXPECT_EQ(alarms.list()[1].from_line, 6U);
}

TEST(ProgramAlarms, TheFirstHundredAreListedAndAllAreCounted) {
  ProgramAlarms alarms;
  for (std::uint32_t line = 1; line <= 300; ++line) {
    alarms.follow(motion_at(line, 1), {.stock_contact_mm = line % 2 == 0 ? 0 : 1.0});
  }
  EXPECT_EQ(alarms.count(), 150U);
  EXPECT_EQ(alarms.list().size(), ProgramAlarms::kListedMax);
  EXPECT_EQ(alarms.list().back().to_line, 199U);
}

constexpr const char* kShankScene = R"({
  "name": "Deep",
  "stock": {"shape": "box", "min_mm": [-20, -20, -20], "max_mm": [20, 20, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "flat", "diameter_mm": 6, "length_mm": 4,
             "shank": {"diameter_mm": 8, "length_mm": 30}}]})";

TEST_F(SessionTest, CrashingProgramListsAlarmsWithPositions) {
  const auto session = start(kShankScene);
  const auto program =
      test::value_of(parse_program("crash.ngc",
                                   "G21 G90 T1 M6\n"  // line 1
                                   "G0 X-30 Y0 Z-2\n"
                                   "G0 X0\n"        // through the stock
                                   "G0 Z9\n"        // out of it
                                   "G0 Y10\n"       // line 5
                                   "G1 Z-6 F600\n"  // 2 mm deeper than the tool cuts
                                   "G1 Z9\nM2\n",
                                   *session->scene()));
  const auto id = session->programs().start(program, {})->id;
  while (session->programs().status(id)->state == ProgramState::kRunning) executor->run();
  const ProgramStatus status = *session->programs().status(id);
  EXPECT_EQ(status.state, ProgramState::kFinished);
  ASSERT_EQ(status.alarms.size(), 2U);
  EXPECT_EQ(status.alarm_count, 2U);
  EXPECT_EQ(status.alarms[0].kind, AlarmKind::kRapid);
  EXPECT_EQ(status.alarms[0].from_line, 3U);
  EXPECT_NEAR(status.alarms[0].amount, 2, 1e-3);
  // A slot with a round end.
  EXPECT_NEAR(status.alarms[0].removed_mm3, 6 * 2 * 20 + 3.1416 * 9, 5);
  EXPECT_EQ(status.alarms[1].kind, AlarmKind::kShank);
  EXPECT_EQ(status.alarms[1].from_line, 6U);
  EXPECT_NEAR(status.alarms[1].amount, 1, 1.01);
  const auto json = nlohmann::json::parse(program_json(status));
  EXPECT_EQ(json.at("alarms").at(1).at("kind"), "shank");
  EXPECT_EQ(json.at("alarms").at(0).at("unit"), "mm");
  EXPECT_EQ(json.at("alarms").at(0).at("limit"), 0.02);
  EXPECT_EQ(json.at("alarms").at(1).at("limit"), 0.01);
  EXPECT_EQ(json.at("alarm_count"), 2);
}

TEST_F(SessionTest, FramesIncludeProgramsOnlyAfterAChange) {
  const auto session = start();
  EXPECT_FALSE(session->frame(true).programs);
  Program program{.motions = {motion_at(1, 1)}};
  program.motions[0].duration_s = 1000;
  const auto id = session->programs().start(program, {ProgramPace::kFeed})->id;
  auto update = session->frame(false).programs;
  ASSERT_TRUE(update);
  EXPECT_EQ(update->at(0).state, ProgramState::kRunning);
  EXPECT_FALSE(session->frame(false).programs);
  EXPECT_TRUE(session->frame(true).programs);
  session->programs().order(id, ProgramOrder::kPause);
  EXPECT_FALSE(session->frame(false).programs) << "four times a second at most";
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(9);
  while (!(update = session->frame(false).programs) && std::chrono::steady_clock::now() < end) {
  }
  ASSERT_TRUE(update);
  EXPECT_EQ(update->at(0).state, ProgramState::kPaused);
  EXPECT_FALSE(session->frame(false).programs);
  for (int n = 0; n < 7; ++n) (void)session->programs().start(Program{}, {});
  update = session->frame(true).programs;
  ASSERT_EQ(update->size(), 1 + ProgramRuns::kEndedShown);
  EXPECT_EQ(update->front().id, id);
  EXPECT_EQ(update->back().id, id + 7);
}

}  // namespace
}  // namespace kerf::program_alarms_test
