// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/dexel/normal_code.h"
#include "kernel/math/vec3_lanes.h"
#include "kernel/sweep/tool_motion.h"
#include "kernel/sweep/turning_frame.h"
#include "kernel/tool/tool.h"

namespace kerf {

/// Normals of the surface that a tool sweeps on the true motion between two poses whose axes are
/// less than kTurnPerFrameMaxRad apart, at points on that surface (to the sweep's tolerance).
///
/// A point P on it touches the tool at the share s of the motion at which the tool's signed
/// distance from P is least. The normal there is the tool's, and n·V = 0 unless s is the start or
/// end of the motion (paper section 2.3). Along the motion that distance has a single minimum,
/// because the tool's pieces are convex. If the minimum is on the edge between a side and a disc,
/// the normal is the one between theirs with n·V = 0 (the paper's pipe).
class SweptSurface {
 public:
  SweptSurface(const Tool& tool, const ToolMotion& motion);

  /// Computes the codes of the stock's outward normals, which point into the swept volume, at eight
  /// ends of its elements (mm). Valid for ends with a bit in `asked`. `towards` is 1 for upper
  /// ends, whose normals cannot point down, and −1 for lower ends, whose normals cannot point up.
  void stock_normals(const Vec3Lanes& ends_mm, unsigned asked, double towards,
                     NormalCode* codes) const;
  /// As above, inlined into a function that is compiled for one instruction set.
  void stock_normals_in_lanes(const Vec3Lanes& ends_mm, unsigned asked, double towards,
                              NormalCode* codes) const;

 private:
  struct Contact {
    Lanes gap;         ///< distance of the point from the piece, negative inside
    Vec3Lanes normal;  ///< of the piece; for a ball not of unit length
    Lanes advance;     ///< n·V of the piece
    Lanes by_side;     ///< distance from the side minus that from the discs
  };

  Contact contact(const PieceProfile& piece, const Vec3Lanes& point, Lanes share) const;
  Contact ball_contact(const PieceProfile& ball, const Vec3Lanes& point) const;
  Contact nearest(const PieceProfile& piece, const Vec3Lanes& point, LaneMask asked) const;

  TurningFrame frame_;
  double speed_max_;  ///< greatest speed of a point of the tool, mm per unit of share
  std::vector<PieceProfile> pieces_;
};

}  // namespace kerf
