// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/recording_about.h"

#include <kerf/version.h>

#include <sstream>
#include <utility>

#include "kernel/kernel_version.h"

namespace kerf::agent {
namespace {

template <typename T>
std::string text_of(const T& value) {
  std::ostringstream out;
  constexpr int kDigits = 15;
  out.precision(kDigits);
  out << value;
  return out.str();
}

std::string text_of(Vec3 v) { return text_of(v.x) + ' ' + text_of(v.y) + ' ' + text_of(v.z); }

/// Metadata about the program, the loop and its device.
mcap::Texts about_loop(const DeviceCapabilities& device, const ServoSettings& settings) {
  const WorkspaceMapping& mapping = settings.mapping.at_start;
  return {{"agent_version", kVersion},
          {"kernel_version", text_of(kKernelVersion)},
          {"tool_id", text_of(settings.tool_id)},
          {"pivot_mm", text_of(settings.pivot_mm)},
          {"mode", std::string(to_string(settings.mode))},
          {"limit_force_n", text_of(settings.limits.force_n)},
          {"limit_torque_nmm", text_of(settings.limits.torque_nmm)},
          {"device", device.name},
          {"device_sensed_dof", text_of(device.sensed_dof)},
          {"device_actuated_dof", text_of(device.actuated_dof)},
          {"device_max_force_n", text_of(device.max_force_n)},
          {"device_max_torque_nmm", text_of(device.max_torque_nmm)},
          {"device_max_stiffness_n_per_mm", text_of(device.max_stiffness_n_per_mm)},
          {"device_max_damping_n_s_per_mm", text_of(device.max_damping_n_s_per_mm)},
          {"device_latency_us", text_of(settings.passivity.latency_us)},
          {"device_moving_mass_kg", text_of(device.moving_mass_kg)},
          {"device_moving_inertia_kg_m2", text_of(device.moving_inertia_kg_m2)},
          {"device_resolution_mm", text_of(device.resolution_mm)},
          {"device_resolution_rad", text_of(device.resolution_rad)},
          {"device_has_deadman", device.has_deadman ? "true" : "false"},
          {"mapping_scale", text_of(mapping.scale)},
          {"mapping_gain", text_of(mapping.gain)},
          {"mapping_turn_rad", text_of(mapping.turn_rad)},
          {"mapping_device_mm", text_of(mapping.device_mm)},
          {"mapping_block_mm", text_of(mapping.block_mm)}};
}

}  // namespace

mcap::Texts about_session(const std::string& user, const Welcome& welcome,
                          const DeviceCapabilities& device, const ServoSettings& settings) {
  mcap::Texts about = about_loop(device, settings);
  about["session"] = welcome.session;
  about["participant"] = text_of(welcome.participant);
  about["name"] = user;
  about["stock_min_mm"] = text_of(welcome.stock.min_mm);
  about["stock_max_mm"] = text_of(welcome.stock.max_mm);
  about["force_law"] = to_string(welcome.law);
  return about;
}

mcap::Texts about_playing(const mcap::Texts& recorded, const std::string& file,
                          const DeviceCapabilities& device, const ServoSettings& settings) {
  mcap::Texts about = about_loop(device, settings);
  for (const char* key : {"session", "stock_min_mm", "stock_max_mm", "force_law"}) {
    if (const auto found = recorded.find(key); found != recorded.end()) about.insert(*found);
  }
  about["feel_of"] = file;
  return about;
}

}  // namespace kerf::agent
