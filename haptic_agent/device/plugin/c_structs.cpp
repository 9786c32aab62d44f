// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/plugin/c_structs.h"

#include <cmath>
#include <span>
#include <sstream>
#include <string_view>

#include "haptic_agent/device/ranges.h"
#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/device/usb/device_mailbox.h"
#include "server/wire/types.h"

namespace kerf::agent {
namespace {

constexpr std::size_t kNameBytes = 64;
/// A lower band would delay the force of a cut itself.
constexpr std::uint32_t kMinVibrationHz = 20, kMaxVibrationHz = 1000;

constexpr std::uint32_t kKnownFlags = KERF_AGENT_HAS_DEADMAN | KERF_AGENT_ALWAYS_CUT;

struct Range {
  std::string_view field;
  double value, most;
};

Vec3 vec_of(const double (&v)[3]) noexcept { return {v[0], v[1], v[2]}; }

/// Returns the first field outside 0 ... most. Empty if there is none.
std::string fault_of(std::span<const Range> ranges) {
  for (const Range& range : ranges) {
    if (range.value >= 0 && range.value <= range.most) continue;
    std::ostringstream text;
    text << range.field << " is " << range.value << ", it must be 0 to " << range.most;
    return text.str();
  }
  return {};
}

bool is_dof(std::uint32_t dof) noexcept { return dof == 0 || dof == 3 || dof == 5; }

std::string fault_of(const kerf_agent_capabilities& given) {
  const Range ranges[] = {
      {"max_force_n", given.max_force_n, 100},
      {"max_torque_nmm", given.max_torque_nmm, 10'000},
      {"continuous_force_n", given.continuous_force_n, 100},
      {"continuous_torque_nmm", given.continuous_torque_nmm, 10'000},
      {"max_stiffness_n_per_mm", given.max_stiffness_n_per_mm, 100},
      {"max_damping_n_s_per_mm", given.max_damping_n_s_per_mm, 1},
      {"latency_us", static_cast<double>(given.latency_us), kLatencyMaxUs},
      {"max_vibration_hz", static_cast<double>(given.max_vibration_hz), kMaxVibrationHz},
      {"moving_mass_kg", given.moving_mass_kg, kMovingMassMaxKg},
      {"moving_inertia_kg_m2", given.moving_inertia_kg_m2, kMovingInertiaMaxKgM2},
      {"resolution_mm", given.resolution_mm, kResolutionMaxMm},
      {"resolution_rad", given.resolution_rad, kResolutionMaxRad},
  };
  if (std::string fault = fault_of(ranges); !fault.empty()) return fault;
  if (given.max_vibration_hz != 0 && given.max_vibration_hz < kMinVibrationHz) {
    return "max_vibration_hz must be 0, if it is unknown, or at least 20";
  }
  if (!is_dof(given.sensed_dof)) return "sensed_dof must be 3 or 5";
  if (!is_dof(given.actuated_dof)) return "actuated_dof must be 0, 3 or 5";
  if ((given.max_force_n > 0) != (given.actuated_dof > 0)) {
    return "max_force_n and actuated_dof must both be 0, for a device without motors, or neither";
  }
  if ((given.flags & ~kKnownFlags) != 0) return "unknown bits in flags";
  for (int i = 0; i < 3; ++i) {
    const double least = given.workspace_min_mm[i], most = given.workspace_max_mm[i];
    if (!(std::abs(least) <= kWorkspaceMaxMm && std::abs(most) <= kWorkspaceMaxMm &&
          least <= most)) {
      return "workspace_min_mm must not exceed workspace_max_mm, both within 100000 mm";
    }
  }
  return {};
}

}  // namespace

std::expected<DeviceCapabilities, std::string> capabilities_of(
    const kerf_agent_capabilities& given) {
  if (std::string fault = fault_of(given); !fault.empty()) return std::unexpected(fault);
  const std::string_view name = given.name != nullptr ? given.name : "device";
  const bool torque = given.actuated_dof == 5;
  return DeviceCapabilities{
      .name = std::string(shortened(name, kNameBytes)),
      .sensed_dof = given.sensed_dof == 0 ? 5 : static_cast<int>(given.sensed_dof),
      .actuated_dof = static_cast<int>(given.actuated_dof),
      .max_force_n = given.max_force_n,
      .max_torque_nmm = torque ? given.max_torque_nmm : 0,
      .continuous_force_n = given.continuous_force_n,
      .continuous_torque_nmm = given.continuous_torque_nmm,
      .max_stiffness_n_per_mm = given.max_stiffness_n_per_mm,
      .max_damping_n_s_per_mm = given.max_damping_n_s_per_mm,
      .max_vibration_hz = static_cast<double>(given.max_vibration_hz),
      .latency_us = given.latency_us,
      .resolution_mm = given.resolution_mm,
      .resolution_rad = given.resolution_rad,
      .moving_mass_kg = given.moving_mass_kg,
      .moving_inertia_kg_m2 = given.moving_inertia_kg_m2,
      .workspace_min_mm = vec_of(given.workspace_min_mm),
      .workspace_max_mm = vec_of(given.workspace_max_mm),
      .has_deadman = (given.flags & KERF_AGENT_HAS_DEADMAN) != 0,
      .always_cut = (given.flags & KERF_AGENT_ALWAYS_CUT) != 0};
}

bool is_pose(const kerf_agent_pose& pose) noexcept {
  if (pose.state != KERF_AGENT_READY && pose.state != KERF_AGENT_FINISHED) return true;
  return is_finite(vec_of(pose.tip_mm)) &&
         std::abs(length(vec_of(pose.axis)) - 1) <= wire::kAxisLengthTolerance / 2;
}

static_assert(KERF_AGENT_UNDO == kButtonUndo && KERF_AGENT_REDO == kButtonRedo);
static_assert(KERF_AGENT_REARM == kButtonRearm && KERF_AGENT_CLUTCH == kButtonClutch);
constexpr std::uint32_t kKnownButtons = wire::kButtonCutting | wire::kButtonDeadman | kButtonUndo |
                                        kButtonRedo | kButtonRearm | kButtonClutch;

DeviceState state_of(const kerf_agent_pose& pose, bool has_deadman, std::uint64_t now_us) noexcept {
  DeviceState state{.tip_mm = vec_of(pose.tip_mm),
                    .axis = vec_of(pose.axis),
                    .buttons = pose.buttons & kKnownButtons,
                    .tool_id = pose.tool_id,
                    .time_us = pose.time_us != 0 ? pose.time_us : now_us};
  const bool current = state.time_us > now_us ? state.time_us - now_us <= DeviceMailbox::kPoseLifeUs
                                              : now_us - state.time_us < DeviceMailbox::kPoseLifeUs;
  switch (pose.state) {
    case KERF_AGENT_FINISHED:
      state.finished = true;
      [[fallthrough]];
    case KERF_AGENT_READY:
      state.phase = DevicePhase::kReady;
      state.valid = current;
      break;
    case KERF_AGENT_HOMING:
      state.phase = DevicePhase::kHoming;
      break;
    case KERF_AGENT_FAULT:
      state.phase = DevicePhase::kIdentified;
      break;
    default:
      break;
  }
  if (!has_deadman && state.valid) state.buttons |= wire::kButtonDeadman;
  return state;
}

kerf_agent_wrench wrench_of(const Wrench& wrench) noexcept {
  return {.struct_size = sizeof(kerf_agent_wrench),
          .reserved = 0,
          .force_n = {wrench.force_n.x, wrench.force_n.y, wrench.force_n.z},
          .torque_nmm = {wrench.torque_nmm.x, wrench.torque_nmm.y, wrench.torque_nmm.z}};
}

}  // namespace kerf::agent
