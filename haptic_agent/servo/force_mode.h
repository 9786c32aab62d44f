// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf::agent {

/// How the session's answers are rendered.
enum class ForceMode : std::uint8_t {
  /// Local model, extrapolated to the current pose: accurate at any delay.
  kModel,
  /// Zhu & Lee: linear interpolation from the previous wrench to the newest.
  kInterpolated,
  /// The newest wrench until the next.
  kHold,
  /// Zhu & Lee, section 4, with its rates: a wrench every 10 ms, interpolated over 10 ms.
  kPaper,
  /// No force of the session; between the intervals of a comparison (haptic_agent/study).
  kSilent,
};

}  // namespace kerf::agent
