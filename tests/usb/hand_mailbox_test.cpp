// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/usb/hand_mailbox.h"

#include <gtest/gtest.h>

#include <limits>

namespace kerf::agent {
namespace {

constexpr Wrench kPush{.force_n = {3, 0, 0}, .torque_nmm = {}};

class HandMailboxTest : public ::testing::Test {
 protected:
  /// What the motors should show so long after what was written last was written, or later.
  Wrench after(std::uint64_t us) {
    bool fresh = false;
    return box.wanted(monotonic_us() + us, fresh);
  }
  /// What they should show for as long as it is not old by this clock, however slow the test is.
  Wrench at_once() {
    bool fresh = false;
    return box.wanted(written_us, fresh);
  }
  void show(const Wrench& wrench) {
    written_us = monotonic_us();
    box.show(wrench);
  }

  HandMailbox box;
  std::uint64_t written_us = 0;
};

TEST_F(HandMailboxTest, AWrenchLivesTenMilliseconds) {
  EXPECT_EQ(at_once(), Wrench{});
  show(kPush);
  EXPECT_EQ(at_once(), kPush);
  EXPECT_EQ(at_once(), kPush) << "until the next";
  EXPECT_EQ(after(kWrenchLifeUs), Wrench{});
}

TEST_F(HandMailboxTest, StopHoldsUntilTheNextWrench) {
  show(kPush);
  box.stop();
  EXPECT_EQ(at_once(), Wrench{});
  show(kPush);
  EXPECT_EQ(at_once(), kPush);
}

TEST_F(HandMailboxTest, StopIsSomethingNewToTell) {
  bool fresh = false;
  show(kPush);
  box.wanted(written_us, fresh);
  EXPECT_TRUE(fresh);
  box.wanted(written_us, fresh);
  EXPECT_FALSE(fresh);
  box.stop();
  box.wanted(written_us, fresh);
  EXPECT_TRUE(fresh);
}

TEST_F(HandMailboxTest, AWrenchThatIsNotFiniteIsNone) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  show({.force_n = {0, kNone, 0}, .torque_nmm = {}});
  EXPECT_EQ(at_once(), Wrench{});
  show({.force_n = {1, 0, 0}, .torque_nmm = {0, 0, kNone}});
  EXPECT_EQ(at_once(), Wrench{});
}

TEST_F(HandMailboxTest, APoseLivesTwentyMilliseconds) {
  EXPECT_FALSE(box.fetch(0).valid);
  box.publish({.time_us = 1000, .valid = true});
  EXPECT_TRUE(box.fetch(1000 + HandMailbox::kPoseLifeUs - 1).valid);
  EXPECT_FALSE(box.fetch(1000 + HandMailbox::kPoseLifeUs).valid);
}

}  // namespace
}  // namespace kerf::agent
