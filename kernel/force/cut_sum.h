// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kernel/cut/removal.h"
#include "kernel/dexel/column_shares.h"
#include "kernel/dexel/dexel_grid.h"
#include "kernel/math/lanes.h"
#include "kernel/math/rotation.h"
#include "kernel/math/wrench.h"

namespace kerf {

class SurfaceWeight;

/// Sums over the removed elements of a cut, before a force law scales them to newtons. Each element
/// has a volume V, a center r relative to the tip, and a unit direction f in which it pushes.
struct CutSum {
  double volume_mm3 = 0;
  Vec3 moment_mm4;  ///< Σ V r
  Vec3 push_mm3;    ///< Σ V f (paper Eq. 23)
  Vec3 turn_mm4;    ///< Σ V (r − pivot) × f (Eq. 24), without its component about the axis

  /// Returns the centroid of the volume relative to the tip (mm), or zero if nothing was removed.
  Vec3 center_mm() const { return volume_mm3 > 0 ? moment_mm4 * (1 / volume_mm3) : Vec3{}; }
};

constexpr CutSum operator+(const CutSum& a, const CutSum& b) {
  return {a.volume_mm3 + b.volume_mm3, a.moment_mm4 + b.moment_mm4, a.push_mm3 + b.push_mm3,
          a.turn_mm4 + b.turn_mm4};
}
constexpr CutSum operator*(const CutSum& a, double s) {
  return {a.volume_mm3 * s, a.moment_mm4 * s, a.push_mm3 * s, a.turn_mm4 * s};
}
/// Returns the sum that results if the tool, its axis and the cut are turned together.
constexpr CutSum turned(const CutSum& s, const Turn& turn) {
  return {s.volume_mm3, turn(s.moment_mm4), turn(s.push_mm3), turn(s.turn_mm4)};
}

/// A cut and the displacements of its elements over the sub-motion, weighted by volume. The lengths
/// are root mean squares in the frame of the field.
struct MovedSum {
  CutSum cut;
  double across_mm = 0;  ///< of the components across the rays
  double along_mm = 0;   ///< of the components along the rays
};

/// The pose of a tool at the middle of a sub-motion, in the frame of a field, and its size.
struct CutFrame {
  Vec3 tip_mm, axis;
  double pivot_mm;   ///< distance of the torque's pivot from the tip
  double reach_mm;   ///< greatest distance of a point of the tool from its tip
  double radius_mm;  ///< of the tool
};

/// The tip of a tool in the units of a grid, for positions relative to it.
struct TipInGrid {
  double i, j, k, pitch_mm, quantum_mm;
};

/// Sums per SIMD lane over the removed elements of one or more tiles: volume, volume x position,
/// volume x direction, the moment of the latter, and volume x the squares of the displacement
/// across and along the rays. In squares of the pitch.
struct TileSum {
  Lanes volume{}, x{}, y{}, z{};
  Lanes push_x{}, push_y{}, push_z{};
  Lanes turn_x{}, turn_y{}, turn_z{};
  Lanes across2{}, along2{};

  /// Adds lane by lane. A sum over several tiles depends on their order.
  void add(const TileSum& tile);
};

/// Sums the elements that a sub-motion removed from a field. Every element pushes against its own
/// displacement twist.at(r): along the axis in an axial motion (Eq. 20), around the tip in a
/// rotation (Eq. 21), against the tip's displacement in a translation (Eq. 22), and continuously
/// between these. An element that does not move (the degenerate case of Eq. 21) does not push.
class CutSummer {
 public:
  /// `twist` and `frame` are in the frame of the field on `grid`. `weight` weights each element,
  /// and `shares` counts each column by its share; either may be null. Both must outlive this
  /// object.
  CutSummer(const DexelGrid& grid, const Twist& twist, const CutFrame& frame,
            const SurfaceWeight* weight, const ColumnShares* shares = nullptr);

  /// Sums the elements of one tile.
  TileSum sum(std::span<const RemovedGroup> groups) const;
  /// Returns the sums over all tiles, added up in the order of the tiles.
  MovedSum total(const TileSum& sums) const;
  const Twist& twist() const { return twist_; }
  const CutFrame& frame() const { return frame_; }

 private:
  TipInGrid tip_;
  Twist twist_;
  CutFrame frame_;
  const SurfaceWeight* weight_;
  const ColumnShares* shares_;
  Vec3 pivot_;
  bool common_;  ///< all elements push in one direction
};

}  // namespace kerf
