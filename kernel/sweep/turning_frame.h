// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/rotation.h"
#include "kernel/math/vec3_lanes.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// A motion whose axis turns little, relative to its middle: at share s the tip is tip + (s − ½) v
/// and the axis is u cos a + w sin a, a = (s − ½) turn; k = u × w is the axis of the turn. This is
/// the exact motion, not an approximation of it.
struct TurningFrame {
  Vec3 tip, v, u, w, k;
  double turn = 0;

  TurningFrame(const ToolPose& from, const ToolPose& to)
      : tip((from.tip_mm + to.tip_mm) * 0.5),
        v(to.tip_mm - from.tip_mm),
        u(normalized(from.axis + to.axis)) {
    const Vec3 chord = to.axis - from.axis;
    if (chord == Vec3{}) return;
    turn = angle_between(from.axis, to.axis);
    k = normalized(cross(from.axis, to.axis));
    w = cross(k, u);
  }

  /// Poses at eight shares; `tip` is relative to the tip in the middle.
  struct Poses {
    Vec3Lanes tip, u;
  };
  KERF_INLINE Poses at(Lanes share) const {
    const Lanes m = share - 0.5;
    // Up to 0.075 rad the next terms of the series are below 3e-12.
    const Lanes a = m * turn, a2 = a * a;
    const Lanes sine = a * (1 - a2 * (1.0 / 6 - a2 * (1.0 / 120)));
    const Lanes cosine = 1 - a2 * (0.5 - a2 * (1.0 / 24 - a2 * (1.0 / 720)));
    return {v * m, u * cosine + w * sine};
  }
  /// Returns the velocity, per unit of share, of the material point at `from_tip` from the tip.
  KERF_INLINE Vec3Lanes velocity(Vec3Lanes from_tip) const {
    const Vec3 omega = k * turn;
    return v + cross(omega, from_tip);
  }
};

/// Greatest turn for which TurningFrame::at is exact to rounding.
inline constexpr double kTurnPerFrameMaxRad = 0.15;

}  // namespace kerf
