// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "server/formats/gcode/plane.h"

namespace kerf {

/// How the centre of an arc is given, mm.
struct ArcCenter {
  Vec3 ijk;                           ///< offsets from the start, or absolute
  bool absolute = false;              ///< G90.1
  std::optional<double> radius = {};  ///< R form: signed; negative takes the long way round
};

/// An arc, helix or spiral from `start` to `end`: the radius and the height along the normal change
/// uniformly with the angle.
struct Arc {
  Vec3 start, end;
  ArcPlane plane = ArcPlane::kXy;
  double center_first = 0, center_second = 0;  ///< in the plane
  double start_angle_rad = 0;
  double sweep_rad = 0;  ///< > 0 counter-clockwise seen against the normal
  double start_radius = 0, end_radius = 0;
  int turns = 1;  ///< as arc_about takes it

  /// The point at s in [0, 1]; the ends are exact.
  Vec3 at(double s) const;
  double length_mm() const;
  /// Number of equal chords whose sagitta, r (1 - cos(step / 2)), is at most `tolerance_mm`; a
  /// chord spans 45° at most. Chords have their ends on the arc, so the path is never outside of
  /// it.
  int chords(double tolerance_mm) const;
};

/// How far an arc's radii may differ between start and end, mm: the greater of this and 0.1 % of
/// the radius, and never more than a hundred times this. LinuxCNC's figures, for programs in mm and
/// in inches.
inline constexpr double kSpiralToleranceMm = 0.028284271247461905;
inline constexpr double kSpiralToleranceInchMm = 0.07184204896855323;

/// The centre of G2 (clockwise) or G3, in its plane. Throws GcodeFault where LinuxCNC rejects:
/// radii that differ by more than `spiral_tolerance_mm` allows, a centre at an end, an R too short
/// to reach the end, equal ends with R.
PlanePoint arc_center(Vec3 start, Vec3 end, ArcPlane plane, const ArcCenter& center, bool clockwise,
                      double spiral_tolerance_mm = kSpiralToleranceMm);

/// The arc about a known centre. `turns` counts the full circles begun: > 0 counter-clockwise, < 0
/// clockwise, never 0. An arc whose ends are equal in the plane is a full circle.
Arc arc_about(Vec3 start, Vec3 end, ArcPlane plane, PlanePoint center, int turns);

/// arc_about(arc_center()). `turns` (P word) is at least 1.
Arc make_arc(Vec3 start, Vec3 end, ArcPlane plane, const ArcCenter& center, bool clockwise,
             int turns);

}  // namespace kerf
