// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/rotation.h"
#include "kernel/math/vec3_lanes.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// A motion whose axis turns little, relative to its middle. At share s the tip is tip + (s − ½) v
/// and the axis is u cos a + w sin a, a = (s − ½) turn. k = u × w is the axis of the turn. This is
/// the exact motion, not an approximation of it.
struct TurningFrame {
  Vec3 tip, v, u, w, k;
  double turn = 0;
  ToolPose from, to;

  TurningFrame(const ToolPose& first, const ToolPose& last)
      : tip((first.tip_mm + last.tip_mm) * 0.5),
        v(last.tip_mm - first.tip_mm),
        u(normalized(first.axis + last.axis)),
        from(first),
        to(last) {
    const Vec3 chord = to.axis - from.axis;
    if (chord == Vec3{}) return;
    turn = angle_between(from.axis, to.axis);
    k = normalized(cross(from.axis, to.axis));
    w = cross(k, u);
  }

  /// Poses at eight shares.
  struct Poses {
    Vec3Lanes tip, u;
  };
  /// Returns poses whose tips are relative to the tip in the middle.
  KERF_INLINE Poses at(Lanes share) const {
    const Lanes m = share - 0.5;
    // Up to 0.075 rad the next terms of the series are below 3e-12.
    const Lanes a = m * turn, a2 = a * a;
    const Lanes sine = a * (1 - a2 * (1.0 / 6 - a2 * (1.0 / 120)));
    const Lanes cosine = 1 - a2 * (0.5 - a2 * (1.0 / 24 - a2 * (1.0 / 720)));
    return {v * m, u * cosine + w * sine};
  }
  /// Returns poses with absolute tips. At the shares 0 and 1 they equal the end poses of the
  /// motion, to the bit.
  KERF_INLINE Poses placed(Lanes share) const {
    Poses p = at(share);
    p.tip = tip + p.tip;
    const LaneMask starts = share == 0.0, ends = share == 1.0;
    if (any(starts | ends)) {
      put(p, starts, from);
      put(p, ends, to);
    }
    return p;
  }
  /// Returns the velocity, per unit of share, of the material point at `from_tip` from the tip.
  KERF_INLINE Vec3Lanes velocity(Vec3Lanes from_tip) const {
    const Vec3 omega = k * turn;
    return v + cross(omega, from_tip);
  }

  /// Replaces the poses in the lanes `where`.
  KERF_INLINE static void put(Poses& p, LaneMask where, const ToolPose& pose) {
    p.tip.x = select(where, Lanes(pose.tip_mm.x), p.tip.x);
    p.tip.y = select(where, Lanes(pose.tip_mm.y), p.tip.y);
    p.tip.z = select(where, Lanes(pose.tip_mm.z), p.tip.z);
    p.u.x = select(where, Lanes(pose.axis.x), p.u.x);
    p.u.y = select(where, Lanes(pose.axis.y), p.u.y);
    p.u.z = select(where, Lanes(pose.axis.z), p.u.z);
  }
};

/// Greatest turn for which TurningFrame::at is exact to rounding.
inline constexpr double kTurnPerFrameMaxRad = 0.15;

}  // namespace kerf
