// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "kernel/piece/tool_piece.h"
#include "kernel/sweep/column_block.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// Lower bounds of the heights that an upright slice in a level motion removes. At every height the
/// slice is a moving disc, so the distance from the tip's path alone decides, and one test replaces
/// those of Shadow, Underside and Trail (kernel/sweep/bounds.md, "Upright and level").
class LevelBound {
 public:
  /// Returns the bound of a frustum or an arc that moves between two poses, or nothing if the axis
  /// leans or the motion is not level.
  static std::optional<LevelBound> make(const ToolPiece& slice, const ToolPose& from,
                                        const ToolPose& to);

  /// Must be called if the slice at its first pose has already been removed from the stock.
  void set_start_is_cut() { b_.start_is_cut = true; }
  /// Lowers `z_mm` to a lower bound of the heights that are removed within each disc, skipping the
  /// discs behind the tool. Returns the discs (bit i: disc i) that are inside a frustum at its
  /// first pose over its whole height, so that nothing is left for it.
  unsigned lower_bound(const Discs& discs, Lanes& z_mm) const;

  struct Parameters {
    double x, y;          ///< of the first tip
    double dir_x, dir_y;  ///< unit direction of the motion; 0 if it is at rest
    double travel;        ///< mm
    double behind;        ///< mm behind the first axis, from which on the slice recedes
    double lowest;        ///< height of the slice's lower end
    double radius;        ///< greatest radius of the slice
    double inner_radius;  ///< least radius of a frustum; 0 for an arc, for which no disc counts as
                          ///< inside
    bool is_arc;
    double center_r, center_z, arc_radius;  ///< of an arc
    double lower_radius;                    ///< of a frustum, as the next
    double by_slope;                        ///< 1 / slope; 0 if it does not widen
    bool start_is_cut;
  };

 private:
  explicit LevelBound(const Parameters& b) : b_(b) {}

  Parameters b_;
};

}  // namespace kerf
