// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/vec3.h"

namespace kerf::demo {

/// The piece that the demo carves: an ammonite, a ribbed tube coiled along a logarithmic spiral r =
/// R e^(b (a - a_end)), lying in a dish that leaves a frame at the rim of the block. Lengths in mm,
/// angles in rad.
struct Ammonite {
  Vec3 block_min_mm{-60, -48, -32}, block_max_mm{60, 48, 0};
  Vec3 center_mm{-7.5, 6, 0};      ///< of the spiral
  double outer_radius_mm = 49;     ///< R, at the mouth
  double growth_per_turn = 2.15;   ///< e^(2 pi b)
  double mouth_angle_rad = -0.12;  ///< a_end, counted to the right from +X
  double turns = 3.6;              ///< how far the tube goes back from the mouth
  double floor_mm = -15;
  double frame_mm = 3;  ///< width that stays at the rim, where it is narrowest
  int ribs_per_turn = 30;

  /// Height of the wanted surface.
  double height(double x_mm, double y_mm) const;
  /// Height of the dish alone.
  double dish(double x_mm, double y_mm) const;
  /// 0 at the block's middle, 1 on the dish's rim; a superellipse.
  double dish_fraction(double x_mm, double y_mm) const;
  /// Outer radius of the tube at a spiral angle (counted along the coil, mouth_angle_rad at the
  /// mouth).
  double tube_radius(double angle_rad) const;
  /// The point across the tube at a spiral angle: -1 at the inner seam, +1 at the outer one.
  Vec3 across(double angle_rad, double fraction) const;
  /// The angle at which the tube begins.
  double first_angle_rad() const;

 private:
  double tube(double radius_mm, double angle_rad) const;
};

}  // namespace kerf::demo
