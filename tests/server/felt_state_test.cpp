// SPDX-License-Identifier: Apache-2.0
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::felt_state_test {
namespace {

TEST_F(SessionTest, ViewersSeeTheShareOfTheWrenchThatAnAgentStates) {
  const auto session = start();
  const auto id = join(*session);
  const auto state_after = [&](std::uint32_t buttons, float share) {
    wire::MotionSample sample = next(-10 + 0.1 * static_cast<double>(sequence), 0, -2);
    sample.buttons |= buttons;
    sample.felt_share = share;
    EXPECT_TRUE(session->move(id, {&sample, 1}).rejections.empty());
    return session->frame(false).tools.tools.at(0);
  };
  state_after(0, 0);
  const wire::ToolState stated = state_after(wire::kButtonFelt, 0.25F);
  EXPECT_NE(stated.status & wire::kStatusFelt, 0U);
  EXPECT_FLOAT_EQ(stated.felt_share, 0.25F);
  EXPECT_FLOAT_EQ(state_after(wire::kButtonFelt, 7.0F).felt_share, 1.0F) << "a share";
  EXPECT_FLOAT_EQ(state_after(wire::kButtonFelt, -7.0F).felt_share, 0.0F);
  const wire::ToolState silent = state_after(0, 0.25F);
  EXPECT_EQ(silent.status & wire::kStatusFelt, 0U) << "an agent that does not state it";
  EXPECT_EQ(silent.felt_share, 0);
}

}  // namespace
}  // namespace kerf::felt_state_test
