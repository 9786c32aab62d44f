// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "server/formats/control/plane.h"

namespace kerf {

/// The center of an arc as programmed: I J K, or R.
struct ArcCenter {
  Vec3 ijk;                           ///< mm; relative to the start, or absolute
  bool absolute = false;              ///< G90.1: `ijk` are coordinates
  std::optional<double> radius = {};  ///< R form, mm: > 0 for a sweep up to 180°, < 0 above
};

/// An arc, helix or spiral from `start` to `end`, in mm. Radius and height along the plane's normal
/// change uniformly with the angle.
struct Arc {
  Vec3 start, end;
  ArcPlane plane = ArcPlane::kXy;
  double center_first = 0, center_second = 0;  ///< center in the plane (PlanePoint)
  double start_angle_rad = 0;                  ///< from the plane's first axis
  double sweep_rad = 0;                        ///< > 0: counterclockwise seen against the normal
  double start_radius = 0, end_radius = 0;
  int turns = 1;  ///< as for arc_about

  /// Returns the point at s in [0, 1]; s = 0 and 1 give exactly `start` and `end`.
  Vec3 at(double s) const;
  double length_mm() const;
  /// Returns the number of equal chords with a sagitta, r (1 - cos(step / 2)), of at most
  /// `tolerance_mm` and a span of at most 45°. Chords have both ends on the arc, so they never lie
  /// outside of it.
  int chords(double tolerance_mm) const;
};

/// Tolerance of an arc's radius, mm, for programs in mm and in inches. The radii at start and end
/// may differ by this or 0.1 % of the radius, whichever is greater, and by at most 100 times this.
/// LinuxCNC's values.
inline constexpr double kSpiralToleranceMm = 0.028284271247461905;
inline constexpr double kSpiralToleranceInchMm = 0.07184204896855323;

/// Returns the center of G2 (clockwise) or G3 in its plane. Throws ProgramFault where LinuxCNC
/// rejects the arc: radii at start and end differ by more than the tolerance, center at an end, R
/// shorter than half the chord, R with equal ends.
PlanePoint arc_center(Vec3 start, Vec3 end, ArcPlane plane, const ArcCenter& center, bool clockwise,
                      double spiral_tolerance_mm = kSpiralToleranceMm);

/// Makes the arc about a known center. |turns| is the number of turns begun, at least 1; > 0 is
/// counterclockwise, < 0 clockwise. An arc whose ends are equal in the plane is a full circle.
Arc arc_about(Vec3 start, Vec3 end, ArcPlane plane, PlanePoint center, int turns);

/// Makes the arc of G2 or G3: arc_about with arc_center. `turns` (P word) is at least 1.
Arc make_arc(Vec3 start, Vec3 end, ArcPlane plane, const ArcCenter& center, bool clockwise,
             int turns);

}  // namespace kerf
