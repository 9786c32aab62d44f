// SPDX-License-Identifier: Apache-2.0
// Contact planes in the results of a session, and the force of another participant.

#include "tests/server/session_fixture.h"

namespace kerf::contact_test {
namespace {

TEST_F(SessionTest, ReportsAnObstacleBeforeContact) {
  std::string scene = kScene;
  scene.insert(scene.rfind('}'), R"(, "obstacles": [{"shape": "box", "min_mm": [-20, -20, 5],
    "max_mm": [20, 20, 10], "stiffness_n_per_mm": 2}])");
  const auto session = *registry->create("post", scene, SceneSource{});
  const auto id = join(*session);
  for (const double z : {30.0, 12.0, 9.5, 30.0}) {
    wire::MotionSample sample = next(0, 0, z);
    sample.buttons = 0;
    const wire::Result result = session->move(id, {&sample, 1}).result;
    const bool first = sample.agent_sequence == 1;
    ASSERT_EQ(result.plane_count > 0, !first && z < 15) << z;
    if (result.plane_count == 0) continue;
    const wire::ContactPlane& plane = result.planes[0];
    EXPECT_NEAR(double(plane.depth_mm), 10 - z, 1e-6);
    EXPECT_NEAR(double(plane.normal.z), 1, 1e-6);
    EXPECT_NEAR(plane.point_mm.z, z, 1e-9);
    EXPECT_EQ(plane.stiffness_n_per_mm, 2);
    EXPECT_EQ(plane.flags, wire::kContactObstacle);
  }
}

TEST_F(SessionTest, StockPushesAToolThatDoesNotCut) {
  const auto session = start();
  const auto id = join(*session);
  for (const double z : {2.0, -0.5}) {
    wire::MotionSample sample = next(0, 0, z);
    sample.buttons = 0;
    const wire::Result result = session->move(id, {&sample, 1}).result;
    const bool touches = z < 0;
    ASSERT_EQ(result.plane_count, touches ? 1U : 0U);
    if (!touches) continue;
    EXPECT_EQ(result.planes[0].flags, wire::kContactStock);
    EXPECT_NEAR(double(result.planes[0].depth_mm), 0.5, 0.05);
    EXPECT_GT(result.force_n.z, 0.4F) << "upwards, 1 N/mm";
    EXPECT_EQ(result.force_n, result.collision_force_n);
  }
  EXPECT_EQ(session->info().motions, 0U);
}

TEST_F(SessionTest, AgentReceivesTheForceOfAnotherParticipant) {
  const auto session = start();
  const auto teacher = join(*session, "Ada");
  const auto pupil = session->join({ParticipantKind::kAgent, "Grace", "", 1, true, teacher});
  ASSERT_TRUE(pupil);
  move(*session, teacher, -15, 0, -3);
  const auto cut = move(*session, teacher, -14.5, 0, -3);
  ASSERT_GT(cut.result.removed_mm3, 0);
  EXPECT_FALSE(cut.felt) << "the teacher joined without feel_of";
  const auto felt = move(*session, pupil->id, 15, 15, 30).felt;
  ASSERT_TRUE(felt);
  EXPECT_EQ(felt->participant, teacher);
  EXPECT_EQ(felt->force_n, cut.result.force_n);
  session->leave(teacher);
  EXPECT_FALSE(move(*session, pupil->id, 15, 15, 31).felt);
}

}  // namespace
}  // namespace kerf::contact_test
