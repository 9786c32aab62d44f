// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "haptic_agent/device/haptic_device.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// What the server answered to a pose: the wrench, and what it is made of. Both times are on the
/// agent's clock.
struct ServerWrench {
  Wrench wrench{};
  /// When the pose was measured that this answers.
  std::uint64_t pose_us = 0;
  /// When the answer arrived.
  std::uint64_t arrival_us = 0;
  /// Of the cut, mm²; 0: nothing was cut.
  double engaged_area_mm2 = 0;
  Vec3 cut_centre_mm{};
  /// What another participant feels, if the user wants to feel it along.
  Wrench felt{};
  std::uint32_t plane_count = 0;
  std::array<wire::ContactPlane, wire::kMaxContactPlanes> planes{};
};

/// What a result says to the hand.
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
