// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <span>
#include <string>

#include "kernel/sculpture.h"

namespace kerf {

/// Result of validating settings or a command: success, or the first error.
using Check = std::expected<void, SculptureError>;

/// Returns an error.
Check reject(SculptureErrorCode code, std::string reason);
/// Validates stock, pitch, tolerance, force and obstacles.
Check check_settings(const SculptureSettings& settings);
/// Validates that a pose is finite, in range, and has an axis of about unit length. `which`
/// ("start", "end") begins the error text.
Check check_pose(const char* which, const ToolPose& pose);

/// Returns the axes of the fields, in the order in which they are cut and forces are summed.
inline std::span<const RayAxis> axes_of(Rays rays) {
  static constexpr RayAxis kAxes[] = {RayAxis::kZ, RayAxis::kX, RayAxis::kY};
  return {kAxes, rays == Rays::kTriDexel ? 3u : 1u};
}

}  // namespace kerf
