// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

#include "kernel/math/vec3.h"

namespace kerf::demo {

/// A full turn, rad.
constexpr double kTurn = 2 * std::numbers::pi;

/// The target shape of the demo: an ammonite, a ribbed tube coiled along a logarithmic spiral r = R
/// e^(b (a - a_end)), in a dish within a frame at the rim of the block. Lengths in mm, angles in
/// rad.
struct Ammonite {
  Vec3 block_min_mm{-60, -48, -32}, block_max_mm{60, 48, 0};
  Vec3 center_mm{-7.5, 6, 0};      ///< center of the spiral
  double outer_radius_mm = 49;     ///< R, at the mouth
  double growth_per_turn = 2.15;   ///< e^(2 pi b)
  double mouth_angle_rad = -0.12;  ///< a_end, from +X towards +Y
  double turns = 3.6;              ///< length of the tube, back from the mouth
  double floor_mm = -15;
  double frame_mm = 3;  ///< smallest width of the frame at the rim
  int ribs_per_turn = 30;

  /// Returns the height of the target surface.
  double height(double x_mm, double y_mm) const;
  /// Returns the height of the dish without the tube.
  double dish(double x_mm, double y_mm) const;
  /// Returns 0 at the block's center and 1 on the dish's rim, which is a superellipse.
  double dish_fraction(double x_mm, double y_mm) const;
  /// Returns the distance of the tube's outer seam from the spiral's center at a spiral angle
  /// (continuous along the coil; mouth_angle_rad at the mouth).
  double tube_radius(double angle_rad) const;
  /// Returns the point across the tube at a spiral angle. `fraction` is -1 at the inner seam and +1
  /// at the outer one.
  Vec3 across(double angle_rad, double fraction) const;
  /// Returns the angle of the tube's inner end.
  double first_angle_rad() const;

 private:
  double tube(double radius_mm, double angle_rad) const;
};

}  // namespace kerf::demo
