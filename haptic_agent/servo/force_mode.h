// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

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
  /// No force of the session, as between the intervals of a comparison (haptic_agent/study).
  kSilent,
};

inline constexpr std::array<std::string_view, 5> kForceModeNames = {"model", "interpolated", "hold",
                                                                    "paper", "silent"};
constexpr std::string_view to_string(ForceMode mode) noexcept {
  return kForceModeNames[static_cast<std::size_t>(mode)];
}

}  // namespace kerf::agent
