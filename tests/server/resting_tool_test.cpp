// SPDX-License-Identifier: Apache-2.0
#include "server/session/session.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::resting_tool_test {
namespace {

using RestingTool = SessionTest;

TEST_F(RestingTool, CuttingAtRestLeavesTheImprintOnce) {
  const auto session = start();
  const auto id = join(*session);
  move(*session, id, 0, 0, -1);
  const auto before = session->sequence();
  for (int i = 0; i < 10; ++i) move(*session, id, 0, 0, -1);
  EXPECT_EQ(session->sequence(), before + 1);
  const double taken = session->info().removed_mm3;
  EXPECT_GT(taken, 1);
  // Same result as for a motion of 1 µm.
  const auto other = *registry->create("other", kScene, SceneSource{});
  const auto mover = join(*other);
  move(*other, mover, 0, 0, -1);
  move(*other, mover, 0.001, 0, -1);
  EXPECT_NEAR(other->info().removed_mm3, taken, 0.02);
}

TEST_F(RestingTool, IsNotJournaledAtTheEndOfAMotion) {
  const auto session = start();
  const auto id = join(*session);
  for (const double x : {0.0, 1.0}) move(*session, id, x, 0, -1);
  const auto before = session->sequence();
  for (int i = 0; i < 10; ++i) move(*session, id, 1, 0, -1);
  EXPECT_EQ(session->sequence(), before);
}

}  // namespace
}  // namespace kerf::resting_tool_test
