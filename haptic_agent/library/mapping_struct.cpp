// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/library/mapping_struct.h"

#include <cmath>
#include <numbers>

#include "haptic_agent/device/ranges.h"

namespace kerf::agent {
namespace {

constexpr std::uint32_t kKnownFlags = KERF_AGENT_MAPPING_FIT | KERF_AGENT_MAPPING_PLACE;

Vec3 vec_of(const double (&v)[3]) noexcept { return {v[0], v[1], v[2]}; }

/// Zero means 1. Rejects NaN.
bool is_factor(double value, double least, double most) noexcept {
  return value == 0 || (value >= least && value <= most);
}
bool is_within(Vec3 v, double most) noexcept {
  return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
}

/// Returns the fault of a mapping, or null if it has none.
const char* fault_of(const kerf_agent_mapping& given, const SpaceBox& workspace) noexcept {
  if ((given.flags & ~kKnownFlags) != 0) return "unknown bits in flags";
  if (given.flags == kKnownFlags) return "flags: FIT and PLACE exclude each other";
  if (!is_factor(given.scale, kScaleMin, kScaleMax)) return "scale must be 0.001 to 1000, or 0";
  if (!is_factor(given.force_gain, kGainMin, kGainMax)) {
    return "force_gain must be 0.01 to 100, or 0";
  }
  if (!(length(vec_of(given.turn_rad)) <= 2 * std::numbers::pi)) {
    return "turn_rad must be finite and at most 2 pi long";
  }
  if (!is_within(vec_of(given.device_mm), kWorkspaceMaxMm) ||
      !is_within(vec_of(given.block_mm), kWorkspaceMaxMm)) {
    return "device_mm and block_mm must be from -1e5 to 1e5";
  }
  if ((given.flags & KERF_AGENT_MAPPING_FIT) != 0 && !workspace.has_volume()) {
    return "FIT requires the device's workspace: state workspace_min_mm and workspace_max_mm";
  }
  return nullptr;
}

void set(double (&to)[3], Vec3 from) noexcept {
  to[0] = from.x;
  to[1] = from.y;
  to[2] = from.z;
}

}  // namespace

std::expected<MappingRequest, std::string> mapping_request_of(const kerf_agent_mapping& given,
                                                              const SpaceBox& stock,
                                                              const SpaceBox& workspace) {
  if (const char* fault = fault_of(given, workspace)) return std::unexpected(fault);
  const bool fits = (given.flags & KERF_AGENT_MAPPING_FIT) != 0;
  const bool places = (given.flags & KERF_AGENT_MAPPING_PLACE) != 0;
  MappingRequest request{
      .mapping = placed_mapping({.scale = given.scale != 0 ? given.scale : 1,
                                 .fits = fits,
                                 .gain = given.force_gain != 0 ? given.force_gain : 1,
                                 .turn_rad = vec_of(given.turn_rad)},
                                stock, workspace),
      .keeps_tool = !fits && !places};
  if (places) {
    request.mapping.device_mm = vec_of(given.device_mm);
    request.mapping.block_mm = vec_of(given.block_mm);
  }
  return request;
}

kerf_agent_mapping mapping_struct(const WorkspaceMapping& mapping, std::uint32_t flags) noexcept {
  kerf_agent_mapping given{};
  given.struct_size = sizeof given;
  given.flags = flags;
  given.scale = mapping.scale;
  given.force_gain = mapping.gain;
  set(given.turn_rad, mapping.turn_rad);
  set(given.device_mm, mapping.device_mm);
  set(given.block_mm, mapping.block_mm);
  given.stiffness_scale = mapping.stiffness_scale();
  return given;
}

}  // namespace kerf::agent
