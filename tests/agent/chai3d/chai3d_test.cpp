// SPDX-License-Identifier: Apache-2.0
// Tests the adapter for devices of CHAI3D with a device that the test moves.
#include "haptic_agent/examples/kerf_chai3d.h"
#include "tests/agent/link/fake_server.h"
#include "tests/support/test.h"

namespace kerf::agent::chai3d_test {
namespace {

using chai3d::cMatrix3d;
using chai3d::cVector3d;

class FakeDevice final : public chai3d::cGenericHapticDevice {
 public:
  FakeDevice() {
    m_specifications.m_modelName = "fake omega";
    m_specifications.m_maxLinearForce = 12;
    m_specifications.m_maxLinearStiffness = 5000;
    m_specifications.m_maxLinearDamping = 30;
    m_specifications.m_sensedRotation = m_specifications.m_actuatedPosition = true;
  }
  chai3d::cHapticDeviceInfo& specifications() { return m_specifications; }

  bool getPosition(cVector3d& position) override {
    position = cVector3d(0.01, 0.02, 0.03);
    return present;
  }
  bool getRotation(cMatrix3d& rotation) override {
    rotation = turn;
    return true;
  }
  bool getUserSwitch(int index, bool& status) override {
    status = index == 2;
    return true;
  }
  bool setForceAndTorqueAndGripperForce(const cVector3d& f, const cVector3d& t, double) override {
    force = f;
    torque = t;
    return true;
  }

  std::atomic<bool> present{true};
  /// The handle's x axis, which is the direction of the spindle, points up.
  cMatrix3d turn{cVector3d(0, 0, 1), cVector3d(0, 1, 0), cVector3d(-1, 0, 0)};
  cVector3d force, torque;
};

TEST(Chai3d, RatingsComeFromItsSpecifications) {
  FakeDevice device;
  kerf_agent_capabilities rated = kerf_chai3d::capabilities_of(device.getSpecifications(), {});
  EXPECT_EQ(rated.sensed_dof, 5U);
  EXPECT_EQ(rated.actuated_dof, 3U);
  EXPECT_EQ(rated.max_force_n, 12);
  EXPECT_EQ(rated.max_torque_nmm, 0);
  EXPECT_EQ(rated.max_stiffness_n_per_mm, 5);
  EXPECT_DOUBLE_EQ(rated.max_damping_n_s_per_mm, 0.03);
  device.specifications().m_actuatedRotation = true;
  device.specifications().m_maxAngularTorque = 0.2;
  device.specifications().m_maxLinearForce = 500;
  rated = kerf_chai3d::capabilities_of(device.getSpecifications(), {});
  EXPECT_EQ(rated.actuated_dof, 5U);
  EXPECT_DOUBLE_EQ(rated.max_torque_nmm, 200);
  EXPECT_EQ(rated.max_force_n, 100) << "more is not accepted";
  device.specifications().m_actuatedPosition = false;
  rated = kerf_chai3d::capabilities_of(device.getSpecifications(), {});
  EXPECT_EQ(rated.actuated_dof, 0U);
  EXPECT_EQ(rated.max_force_n, 0);
}

TEST(Chai3d, ForceAndTorqueUseItsAxesAndUnits) {
  auto device = std::make_shared<FakeDevice>();
  kerf_chai3d::Agent agent(device, {});
  kerf_agent_wrench wrench{};
  wrench.force_n[0] = 1;
  wrench.force_n[1] = 2;
  wrench.force_n[2] = 3;
  wrench.torque_nmm[1] = 50;
  agent.write(wrench);
  EXPECT_EQ(device->force.x(), -2);
  EXPECT_EQ(device->force.y(), 1);
  EXPECT_EQ(device->force.z(), 3);
  EXPECT_DOUBLE_EQ(device->torque.x(), -0.05);
}

TEST(Chai3d, PoseReachesTheServerWithThePivotAtTheDevice) {
  auto device = std::make_shared<FakeDevice>();
  std::mutex mutex;
  wire::MotionSample seen{};
  FakeServer server([&](FakePeer& peer, int) {
    peer.read_text();
    peer.send_text(welcome_text());
    while (const auto batch = peer.read_motion()) {
      const std::scoped_lock lock(mutex);
      seen = batch->view().back();
      peer.send_result({.agent_sequence = seen.agent_sequence, .agent_time_us = seen.time_us}, 1);
    }
  });
  kerf_chai3d::Settings settings;
  settings.server = "http://127.0.0.1:" + std::to_string(server.port());
  settings.cut_switch = 2;
  {
    kerf_chai3d::Agent agent(device, settings);
    ASSERT_EQ(agent.join(), KERF_AGENT_OK) << kerf_agent_last_error();
    std::thread loop([&] { EXPECT_EQ(agent.run(), KERF_AGENT_OK); });
    for (int i = 0; i < 4000; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      const std::scoped_lock lock(mutex);
      if (seen.agent_sequence > 0) break;
    }
    agent.stop();
    loop.join();
  }
  // Upright: the tip is below the device, whose position is the middle of the stock's top, moved by
  // 20 mm to the right, 10 mm toward the user and 30 mm up.
  EXPECT_NEAR(seen.tip_mm.x, 20, 1e-9);
  EXPECT_NEAR(seen.tip_mm.y, -10, 1e-9);
  EXPECT_NEAR(seen.tip_mm.z, 30, 1e-9);
  EXPECT_NEAR(Vec3(seen.axis).z, 1, 1e-6);
  EXPECT_NE(seen.buttons & wire::kButtonCutting, 0U);
  EXPECT_EQ(device->force.z(), 0);
}

TEST(Chai3d, DeviceWithoutAPositionIsAbsent) {
  auto device = std::make_shared<FakeDevice>();
  device->present = false;
  kerf_chai3d::Agent agent(device, {});
  kerf_agent_pose pose{};
  agent.read(pose);
  EXPECT_EQ(pose.state, static_cast<std::uint32_t>(KERF_AGENT_ABSENT));
}

}  // namespace
}  // namespace kerf::agent::chai3d_test
