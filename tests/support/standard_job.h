// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "kernel/sculpture.h"

namespace kerf::test {

/// The job on which kernels are measured: a 5 mm deep raster with a ball end mill of 10 mm over a
/// block of 100 x 100 x 50 mm, 1 mm moves, rows 2 mm apart at y = 2k + 0.1371. In five axes, the
/// axis also swings by 20 degrees about the tip. The exact removed volume in three axes is
/// 49,666.305 mm^3.
inline constexpr double kStandardRemovedMm3 = 49666.305;
inline constexpr double kStandardRadiusMm = 5;
inline constexpr double kStandardRowOffsetMm = 0.1371;

inline std::vector<ToolPose> standard_path(bool five_axis) {
  std::vector<Vec3> tips;
  for (int k = 0; k <= 50; ++k) {
    const bool forward = k % 2 == 0;
    const double y = 2.0 * k + kStandardRowOffsetMm;
    for (int i = 0; i <= 100; ++i) tips.push_back({forward ? i : 100.0 - i, y, 45});
    if (k < 50) tips.push_back({forward ? 100.0 : 0.0, y + 1, 45});
  }
  std::vector<ToolPose> poses;
  double s = 0;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    if (i > 0) s += length(tips[i] - tips[i - 1]);
    Vec3 axis{0, 0, 1};
    if (five_axis) {
      const double theta = 20 * std::numbers::pi / 180 * std::sin(2 * std::numbers::pi * s / 50);
      const double phi = 2 * std::numbers::pi * s / 330;
      axis = {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    }
    poses.push_back({tips[i], axis});
  }
  return poses;
}

/// Returns the height of the exact three-axis surface at y, away from the ends of the rows.
inline double standard_surface(double y) {
  const double v = y - kStandardRowOffsetMm;
  const double d = std::abs(v - 2 * std::round(v / 2));
  return 50 - std::sqrt(kStandardRadiusMm * kStandardRadiusMm - d * d);
}

inline SculptureSettings standard_settings(double pitch_mm, double tolerance_mm) {
  return SculptureSettings{.stock = BoxStock{{0, 0, 0}, {100, 100, 50}},
                           .pitch_mm = pitch_mm,
                           .tolerance_mm = tolerance_mm,
                           .keep_normals = false,
                           .force = {.pivot_mm = 50}};
}

}  // namespace kerf::test
