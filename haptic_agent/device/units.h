// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf::agent {

/// Factors between SI and the units of poses, wrenches and clocks (mm, N·mm, mJ, µs).
inline constexpr double kMmPerM = 1000.0;
inline constexpr double kNmmPerNm = 1000.0;
inline constexpr double kMjPerJ = 1000.0;
inline constexpr double kUsPerS = 1e6;
inline constexpr double kSPerUs = 1e-6;

}  // namespace kerf::agent
