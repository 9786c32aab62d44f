// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/dexel/normal_code.h"
#include "kernel/math/vec3_lanes.h"
#include "kernel/sweep/tool_motion.h"
#include "kernel/sweep/turning_frame.h"
#include "kernel/tool/tool.h"

namespace kerf {

/// The surface of what a tool sweeps on the true motion between two poses whose axes are less than
/// kTurnPerFrameMaxRad apart: which way it looks at points that lie on it (to the sweep's
/// tolerance). A point P on it touches the tool at the share s of the motion at which the tool's
/// signed distance from P is least; the normal there is the tool's, and n·V = 0 unless s is the
/// motion's begin or end (paper section 2.3). Along the motion that distance has one minimum,
/// because the tool's pieces are convex; where it lies on the edge between a side and a disc, the
/// normal is the one between theirs with n·V = 0 (the paper's pipe).
class SweptSurface {
 public:
  SweptSurface(const Tool& tool, const ToolMotion& motion);

  /// How the stock that the sweep leaves looks at eight ends of its elements (mm), those with a bit
  /// in `asked` at least: the normals into the swept volume. `towards` is 1 for upper ends, which
  /// cannot look down, −1 for lower ends, which cannot look up.
  void stock_normals(const Vec3Lanes& ends_mm, unsigned asked, double towards,
                     NormalCode* codes) const;
  /// The same, as part of a function that is compiled for one instruction set.
  void stock_normals_in_lanes(const Vec3Lanes& ends_mm, unsigned asked, double towards,
                              NormalCode* codes) const;

 private:
  /// How far a point is outside of a piece, the normal there (of a ball not of unit length), n·V of
  /// the piece, and how much farther outside of its side the point is than of its discs.
  struct Contact {
    Lanes gap;
    Vec3Lanes normal;
    Lanes advance;
    Lanes by_side;
  };

  Contact contact(const PieceProfile& piece, const Vec3Lanes& point, Lanes share) const;
  Contact ball_contact(const PieceProfile& ball, const Vec3Lanes& point) const;
  Contact nearest(const PieceProfile& piece, const Vec3Lanes& point, LaneMask asked) const;

  TurningFrame frame_;
  double speed_max_;  ///< fastest that a point of the tool moves, mm per unit of share
  std::vector<PieceProfile> pieces_;
};

}  // namespace kerf
