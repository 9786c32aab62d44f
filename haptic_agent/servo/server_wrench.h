// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "haptic_agent/device/haptic_device.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// The server's answer to a pose: the wrench and its parts. Both times are on the agent's clock.
struct ServerWrench {
  Wrench wrench{};
  /// When the answered pose was measured.
  std::uint64_t pose_us = 0;
  /// When the answer arrived.
  std::uint64_t arrival_us = 0;
  /// Engaged area of the cut, mm², or 0 without a cut.
  double engaged_area_mm2 = 0;
  Vec3 cut_centre_mm{};
  /// Wrench of the participant that this agent follows (--feel); else zero.
  Wrench felt{};
  std::uint32_t plane_count = 0;
  std::array<wire::ContactPlane, wire::kMaxContactPlanes> planes{};

  /// Clears force, area and planes, keeping the times, after the tool has moved away from the
  /// answered position.
  void forget_place() noexcept {
    wrench = {};
    engaged_area_mm2 = 0;
    plane_count = 0;
  }
};

/// Converts a result that arrived at `arrival_us`.
inline ServerWrench answer_of(const wire::Result& result, std::uint64_t arrival_us) noexcept {
  return {.wrench = {.force_n = Vec3(result.force_n), .torque_nmm = Vec3(result.torque_nmm)},
          .pose_us = result.agent_time_us,
          .arrival_us = arrival_us,
          .engaged_area_mm2 = static_cast<double>(result.engaged_area_mm2),
          .cut_centre_mm = result.cut_centre_mm,
          .plane_count = result.plane_count,
          .planes = result.planes};
}

}  // namespace kerf::agent
