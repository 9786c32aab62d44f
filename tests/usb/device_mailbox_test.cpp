// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/usb/device_mailbox.h"

#include "tests/support/test.h"

namespace kerf::agent::device_mailbox_test {
namespace {

constexpr Wrench kPush{.force_n = {3, 0, 0}, .torque_nmm = {}};

class DeviceMailboxTest : public ::testing::Test {
 protected:
  /// Returns the output at least `us` after the last write.
  Wrench after(std::uint64_t us) {
    bool changed = false;
    return box.output(monotonic_us() + us, changed);
  }
  /// Returns the output at the time of the last write, independent of the test's speed.
  Wrench at_once() {
    bool changed = false;
    return box.output(written_us, changed);
  }
  void write(const Wrench& wrench) {
    written_us = monotonic_us();
    box.write(wrench);
  }

  DeviceMailbox box;
  std::uint64_t written_us = 0;
};

TEST_F(DeviceMailboxTest, WrenchIsValidFor10Ms) {
  EXPECT_EQ(at_once(), Wrench{});
  write(kPush);
  EXPECT_EQ(at_once(), kPush);
  EXPECT_EQ(at_once(), kPush) << "repeated until it is too old";
  EXPECT_EQ(after(kWrenchLifeUs), Wrench{});
}

TEST_F(DeviceMailboxTest, StopLastsUntilTheNextWrite) {
  write(kPush);
  box.stop();
  EXPECT_EQ(at_once(), Wrench{});
  write(kPush);
  EXPECT_EQ(at_once(), kPush);
}

TEST_F(DeviceMailboxTest, StopCountsAsChange) {
  bool changed = false;
  write(kPush);
  box.output(written_us, changed);
  EXPECT_TRUE(changed);
  box.output(written_us, changed);
  EXPECT_FALSE(changed);
  box.stop();
  box.output(written_us, changed);
  EXPECT_TRUE(changed);
}

TEST_F(DeviceMailboxTest, NonFiniteWrenchBecomesZero) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  write({.force_n = {0, kNone, 0}, .torque_nmm = {}});
  EXPECT_EQ(at_once(), Wrench{});
  write({.force_n = {1, 0, 0}, .torque_nmm = {0, 0, kNone}});
  EXPECT_EQ(at_once(), Wrench{});
}

TEST_F(DeviceMailboxTest, PoseIsValidFor20Ms) {
  EXPECT_FALSE(box.fetch(0).valid);
  box.publish({.time_us = 1000, .valid = true});
  EXPECT_TRUE(box.fetch(1000 + DeviceMailbox::kPoseLifeUs - 1).valid);
  EXPECT_FALSE(box.fetch(1000 + DeviceMailbox::kPoseLifeUs).valid);
}

}  // namespace
}  // namespace kerf::agent::device_mailbox_test
