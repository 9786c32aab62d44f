#pragma once

#include <optional>

#include "kernel/math/vec3.h"

namespace kerf {

/// The plane of an arc; the normal is the axis that is not in it.
enum class ArcPlane { kXy, kZx, kYz };

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

  /// The point at s in [0, 1]; the ends are exact.
  Vec3 at(double s) const;
  double length_mm() const;
  /// Number of equal chords whose sagitta, r (1 - cos(step / 2)), is at most `tolerance_mm`; a
  /// chord spans 45° at most. Chords have their ends on the arc, so the path is never outside of
  /// it.
  int chords(double tolerance_mm) const;
};

/// Resolves G2 (clockwise) and G3. `turns` (P word) counts the full circles begun, at least 1. An
/// arc whose ends are equal in the plane is a full circle. Throws GcodeFault where LinuxCNC
/// refuses: a radius that differs between start and end by more than 0.5 mm, or by more than 0.005
/// mm and 0.1 %; a centre at the start; an R too short to reach or ends equal in R form.
Arc make_arc(Vec3 start, Vec3 end, ArcPlane plane, const ArcCenter& center, bool clockwise,
             int turns);

}  // namespace kerf
