// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/cut/removal.h"
#include "kernel/cut/workers.h"
#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/math/wrench.h"

namespace kerf {

class SurfaceWeight;

/// What a cut adds up to, before a law makes newtons of it: sums over the removed elements, each
/// with its volume V, its middle r from the tip, and the unit direction f in which it pushes.
struct CutSum {
  double volume_mm3 = 0;
  Vec3 moment_mm4;  ///< Σ V r
  Vec3 push_mm3;    ///< Σ V f (paper Eq. 23)
  Vec3 turn_mm4;    ///< Σ V (r − pivot) × f (Eq. 24), less its part about the tool's axis

  /// Middle of the volume from the tip (mm); the tip itself where nothing was removed.
  Vec3 center_mm() const { return volume_mm3 > 0 ? moment_mm4 * (1 / volume_mm3) : Vec3{}; }
};

constexpr CutSum operator+(const CutSum& a, const CutSum& b) {
  return {a.volume_mm3 + b.volume_mm3, a.moment_mm4 + b.moment_mm4, a.push_mm3 + b.push_mm3,
          a.turn_mm4 + b.turn_mm4};
}
constexpr CutSum operator*(const CutSum& a, double s) {
  return {a.volume_mm3 * s, a.moment_mm4 * s, a.push_mm3 * s, a.turn_mm4 * s};
}

/// Where the tool is while it cuts: the middle pose of a sub-motion, in the frame of a field.
struct CutFrame {
  Vec3 tip_mm, axis;
  double pivot_mm;   ///< of the torque, up the axis
  double reach_mm;   ///< farthest point of the tool from its tip
  double radius_mm;  ///< the tool's
};

/// Sums over what a sub-motion removed from the field that stands on `grid`; `twist` (a
/// displacement, about the tip) and `frame` are given in that field's frame. Every element pushes
/// against its own way, twist.at(r): along the axis where the tool moves along it (Eq. 20), around
/// the tip where it turns (Eq. 21), against the tip's way where it is translated (Eq. 22), and
/// without a jump between these. An element that does not move (the degenerate case of Eq. 21) does
/// not push. `weight`, if not null, says what part of each element counts. The parts of `removal`
/// are divided among `workers`.
CutSum sum_cut(const Removal& removal, const DexelGrid& grid, const Twist& twist,
               const CutFrame& frame, const SurfaceWeight* weight, Workers& workers);

}  // namespace kerf
