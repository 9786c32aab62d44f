// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/piece/tool_piece.h"
#include "kernel/sweep/column_block.h"
#include "kernel/sweep/turning_frame.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// The discs of a slice that are not hidden within its neighbors.
struct ShownDiscs {
  bool lower = false, upper = false;
  bool upper_is_outside = false;  ///< the slice was clipped there, so the disc is outside the block
  bool any() const { return lower || upper; }
};

/// The discs of the plane (bit i: disc i) for which a disc of a slice needs no test.
struct UntestedDiscs {
  unsigned lower = 0, upper = 0;
};

/// Conservative test for regions behind a moving slice of the tool. There, n·V < 0 on its side and
/// on its exposed discs during the whole motion, and the tool at the first pose has already been
/// removed from the stock, so nothing more is removed. The test is cheap compared with the sweep
/// (kernel/sweep/bounds.md, "Behind a tool").
class Trail {
 public:
  /// The slice, a frustum or an arc, moves from one pose to the other. Their axes are less than
  /// kTurnPerFrameMaxRad apart. `tested` has the discs that are tested, and `shown` the exposed
  /// ones among them.
  Trail(const ToolPiece& slice, const ToolPose& from, const ToolPose& to, ShownDiscs tested,
        ShownDiscs shown);
  Trail(const ToolPiece& slice, const ToolPose& from, const ToolPose& to, ShownDiscs shown)
      : Trail(slice, from, to, shown, shown) {}

  /// The discs of the plane (bit i: disc i) over which all tested surfaces of the slice recede, so
  /// that nothing is removed there, or only its exposed surface.
  struct Receding {
    unsigned all, shown;
  };
  Receding receding(const Discs& discs, UntestedDiscs untested = {}) const;
  unsigned behind(const Discs& discs, UntestedDiscs untested = {}) const {
    return receding(discs, untested).all;
  }

  /// A disc of the slice. `sign` is 1 for the upper one, −1 for the lower one.
  struct Face {
    double sign, height, radius;
    bool shown;
  };
  /// Quantities of the test in the middle of the motion. For a point of the side at q from the
  /// axis, n·V times the radius is q·v′ − climb, v′ = v + m w, m = m0 + m1 l, climb = climb0 +
  /// climb1 l.
  struct Motion {
    Vec3 tip, axis, v, w;
    double low, high;  ///< heights of the slice's discs
    double m0, m1, climb0, climb1;
    double radius, lean;  ///< greatest radius; sine of the angle between axis and rays
    double level, level_min, level_max;  ///< horizontal length of the axis; least and greatest
    double by_level;                     ///< 1/level; 0 if the axis may become upright
    double thickness;                    ///< horizontal, along the axis, of half a disc of radius 1
    double aside;        ///< horizontal distance of the side from the axis, along the axis
    double half_travel;  ///< horizontal, of the tip
    double level_speed;  ///< greatest horizontal length of v′
    double bend;         ///< of q·v′ between two heights, per mm²
    double margin, margin_per_mm;  ///< greatest change of n·V until the ends, and over a disc
    bool whole;                    ///< any height of the slice may be over a position of the plane
    /// u·V over the position (x, y) from the tip at the height l: axial − axial_x x − axial_y y −
    /// axial_l l, up to axial_margin + axial_per_mm per mm of distance.
    double axial, axial_x, axial_y, axial_l, axial_margin, axial_per_mm;
    double half_turn;
    /// For an arc: the sines of its normal's angle from the plane across the axis, at its ends.
    bool is_arc;
    double sine_low, sine_high, arc_center_r, arc_radius;
    double by_upright;  ///< 1/u_z; 0 if a position does not determine the distance from the axis
    Face faces[2];      ///< discs that are tested
    int face_count;
  };

 private:
  void set_side(const TurningFrame& f, const FrustumPiece& p);
  void set_axial_speed(const TurningFrame& f);

  Motion m_;
};

}  // namespace kerf
