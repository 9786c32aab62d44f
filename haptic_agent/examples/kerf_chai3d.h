// SPDX-License-Identifier: Apache-2.0
#pragma once

// Lets a device that CHAI3D drives (Force Dimension, Falcon, Phantom, ...) carve in a Kerf session.
// Needs CHAI3D 3.3's headers and libkerf_agent; C++11. chai3d_device.cpp is a complete program.
//
// CHAI3D: m, x toward the user, y right, z up. Kerf: mm, x right, y away from the user, z up. The
// device's point is where its force acts, so it is the pivot of the tool. The center of its
// workspace corresponds to an upright tool whose tip touches the center of the stock's top.

#include <devices/CGenericHapticDevice.h>
#include <kerf/kerf_agent.h>

#include <algorithm>
#include <cstdint>
#include <string>

namespace kerf_chai3d {

constexpr double kMmPerM = 1000;

inline void to_kerf(const chai3d::cVector3d& from, double (&to)[3]) {
  to[0] = from.y();
  to[1] = -from.x();
  to[2] = from.z();
}
inline chai3d::cVector3d to_chai3d(const double (&from)[3], double factor) {
  return chai3d::cVector3d(-from[1] * factor, from[0] * factor, from[2] * factor);
}

/// Properties that CHAI3D's specifications do not state.
struct Settings {
  std::string server = "http://localhost:8080";
  std::string session = "demo";
  std::string name;
  /// Direction from the tip to the spindle in the handle's frame. CHAI3D does not define it.
  chai3d::cVector3d spindle = chai3d::cVector3d(1, 0, 0);
  /// User switch for cutting.
  int cut_switch = 0;
  /// Time from a pose until its force acts; choose a safe upper bound (kerf_agent.h).
  uint32_t latency_us = 3000;
};

/// Returns the ratings of a device, from its CHAI3D specifications.
inline kerf_agent_capabilities capabilities_of(const chai3d::cHapticDeviceInfo& info,
                                               const Settings& settings) {
  kerf_agent_capabilities rated = kerf_agent_capabilities();
  rated.struct_size = sizeof rated;
  rated.sensed_dof = info.m_sensedRotation ? 5 : 3;
  rated.latency_us = settings.latency_us;
  if (!info.m_actuatedPosition || !(info.m_maxLinearForce > 0)) return rated;
  const bool turns = info.m_actuatedRotation && info.m_maxAngularTorque > 0;
  rated.actuated_dof = turns ? 5 : 3;
  rated.max_force_n = std::min(100.0, info.m_maxLinearForce);
  if (turns) rated.max_torque_nmm = std::min(10000.0, info.m_maxAngularTorque * kMmPerM);
  rated.max_stiffness_n_per_mm = std::min(100.0, info.m_maxLinearStiffness / kMmPerM);
  rated.max_damping_n_s_per_mm = std::min(1.0, info.m_maxLinearDamping / kMmPerM);
  return rated;
}

/// An open and calibrated CHAI3D device in a session.
class Agent {
 public:
  Agent(chai3d::cGenericHapticDevicePtr device, const Settings& settings)
      : device_(device), settings_(settings) {}
  ~Agent() { kerf_agent_close(agent_, 1); }
  Agent(const Agent&) = delete;
  Agent& operator=(const Agent&) = delete;

  /// Joins the session; kerf_agent_last_error has the reason of a failure.
  kerf_agent_result join() {
    const chai3d::cHapticDeviceInfo info = device_->getSpecifications();
    name_ = info.m_modelName;
    kerf_agent_capabilities rated = capabilities_of(info, settings_);
    rated.name = name_.c_str();
    turns_ = info.m_sensedRotation;
    kerf_agent_options options = kerf_agent_options();
    options.struct_size = sizeof options;
    options.server = settings_.server.c_str();
    options.session = settings_.session.c_str();
    options.name = settings_.name.c_str();
    options.device = &rated;
    const kerf_agent_result joined = kerf_agent_connect(&options, &agent_);
    if (joined != KERF_AGENT_OK) return joined;
    session_ = kerf_agent_session();
    session_.struct_size = sizeof session_;
    return kerf_agent_get_session(agent_, &session_);
  }
  /// Exchanges poses and forces at 1 kHz until `stop` or the connection is lost.
  kerf_agent_result run() {
    kerf_agent_device loop = kerf_agent_device();
    loop.struct_size = sizeof loop;
    loop.abi = KERF_AGENT_ABI;
    loop.read_pose = [](void* self, uint64_t, kerf_agent_pose* pose) {
      static_cast<Agent*>(self)->read(*pose);
    };
    loop.write_wrench = [](void* self, const kerf_agent_wrench* wrench) {
      static_cast<Agent*>(self)->write(*wrench);
    };
    return kerf_agent_run(agent_, &loop, this);
  }
  /// From any thread.
  void stop() { kerf_agent_stop(agent_); }
  kerf_agent* handle() const { return agent_; }

  /// Sets the pose of the tool; leaves it absent if the device has none.
  void read(kerf_agent_pose& pose) {
    chai3d::cVector3d at, spindle(0, 0, 1);
    if (!device_->getPosition(at)) return;
    if (turns_) {
      chai3d::cMatrix3d rotation;
      if (!device_->getRotation(rotation)) return;
      spindle = rotation * settings_.spindle;
      spindle.normalize();
    }
    bool cut = false;
    device_->getUserSwitch(settings_.cut_switch, cut);
    double pivot_mm[3];
    to_kerf(at * kMmPerM, pivot_mm);
    to_kerf(spindle, pose.axis);
    for (int i = 0; i < 3; ++i) {
      const double low = session_.stock_min_mm[i], high = session_.stock_max_mm[i];
      const double middle = i == 2 ? high + session_.pivot_mm : (low + high) / 2;
      pose.tip_mm[i] = middle + pivot_mm[i] - session_.pivot_mm * pose.axis[i];
    }
    pose.buttons = cut ? KERF_AGENT_CUT : 0;
    pose.state = KERF_AGENT_READY;
  }
  void write(const kerf_agent_wrench& wrench) {
    device_->setForceAndTorqueAndGripperForce(to_chai3d(wrench.force_n, 1),
                                              to_chai3d(wrench.torque_nmm, 1 / kMmPerM), 0);
  }

 private:
  chai3d::cGenericHapticDevicePtr device_;
  Settings settings_;
  std::string name_;
  bool turns_ = false;
  kerf_agent* agent_ = nullptr;
  kerf_agent_session session_ = kerf_agent_session();
};

}  // namespace kerf_chai3d
