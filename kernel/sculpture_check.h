// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <span>
#include <string>

#include "kernel/sculpture.h"

namespace kerf {

/// What settings and commands are checked for before anything is changed: nothing, or the first
/// fault with one sentence that names the field.
using Check = std::expected<void, SculptureError>;

Check reject(SculptureErrorCode code, std::string reason);
/// Stock, pitch, tolerance, force and obstacles.
Check check_settings(const SculptureSettings& settings);
/// Finite, in range, with an axis of about unit length; `which` begins the sentence.
Check check_pose(const char* which, const ToolPose& pose);

/// The axes of the fields, in the order in which they are cut, and in which forces are summed.
inline std::span<const RayAxis> axes_of(Rays rays) {
  static constexpr RayAxis kAxes[] = {RayAxis::kZ, RayAxis::kX, RayAxis::kY};
  return {kAxes, rays == Rays::kTriDexel ? 3u : 1u};
}

}  // namespace kerf
