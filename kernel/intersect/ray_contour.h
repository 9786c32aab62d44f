// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/lanes.h"
#include "kernel/math/span.h"
#include "kernel/math/tolerance.h"
#include "kernel/math/vec3.h"
#include "kernel/piece/arc.h"

namespace kerf {

/// Intersection of eight dexel rays with the surface that the contour of an arc's side, n·d = 0,
/// sweeps along the displacement d (kernel/intersect/README.md, "Contour of an arc"). Seen along d
/// the contour is an ellipse, offset by the arc's radius. Let b be the horizontal direction across
/// d, and a ⟂ b, with d pointing upwards. The unit normal n = q b ± √(1 − q²) a gives the contour's
/// distance Y(q) along b, which increases with q at the rate of its radius of curvature. A ray at
/// the distance y meets the contour where Y(q) = y.
class RayContour {
 public:
  RayContour(const ArcPiece& piece, Vec3 tip_mm, Vec3 unit_axis, Vec3 displacement_mm);

  KERF_INLINE void extend(LaneSpan& span, Lanes x, Lanes y) const {
    if (!exists_) return;
    const Lanes px = x - center_.x, py = y - center_.y;
    extend_by(span, branches_[0], px, py);
    extend_by(span, branches_[1], px, py);
  }

 private:
  /// The contour on one side of the axis, at the upper or the lower ends of rays: from the normal
  /// q0 at the distance y0 to q1 > q0 at y1. It does not exist if y0 > y1. Rays from y_min to y_max
  /// meet it, up to rounding.
  struct Flank {
    double q0 = 0, q1 = 0, y0 = 1, y1 = -1, y_min = 1, y_max = -1;
  };
  /// The contour at the lower (up < 0) or the upper ends of rays.
  struct Branch {
    double up;
    Flank flanks[2];
  };
  /// A point of the contour: distance along b, its derivative by q, and 1/√(1 − (n·u)²).
  struct At {
    Lanes y, slope, up, inverse;
  };

  Flank flank(double up, double side) const;
  Flank between(double side, double sine0, double sine1) const;

  /// Returns the point of the contour whose normal is q b + up √(1 − q²) a.
  KERF_INLINE At at(double up, Lanes q) const {
    At p;
    p.up = square_root(greater(1 - q * q, Lanes(0))) * up;
    const Lanes across = q * across_b_ + p.up * across_a_, along = q * along_b_ + p.up * along_a_;
    const Lanes square = across * across + flat2_ * (along * along);
    p.inverse = 1 / square_root(square);
    p.y = center_r_ * ((across * across_b_ + flat2_ * along * along_b_) * p.inverse) + radius_ * q;
    p.slope = radius_ + center_r_ * flat2_ * (p.inverse * p.inverse * p.inverse);
    return p;
  }

  KERF_INLINE void extend_by(LaneSpan& span, const Branch& branch, Lanes px, Lanes py) const {
    const Lanes y = px * b_.x + py * b_.y;
    const Flank &f = branch.flanks[0], &g = branch.flanks[1];
    const LaneMask on_f = (y >= f.y_min) & (y <= f.y_max);
    LaneMask asked = on_f | ((y >= g.y_min) & (y <= g.y_max));
    if (!any(asked)) return;
    const auto pick = [&](double first, double second) {
      return select(on_f, Lanes(first), Lanes(second));
    };
    const Lanes y0 = pick(f.y0, g.y0), y1 = pick(f.y1, g.y1);
    Lanes low = pick(f.q0, g.q0), high = pick(f.q1, g.q1);
    Lanes q = low + (high - low) * ((y - y0) / (y1 - y0));
    q = lesser(greater(q, low), high);
    At p = at(branch.up, q);
    LaneMask moving = asked;
    for (int i = 0; i < kSteps; ++i) {
      const Lanes off = p.y - y;
      moving &= magnitude(off) > kArcFoundMm;
      if (!any(moving)) break;
      low = select(off < 0.0, q, low);
      high = select(off < 0.0, high, q);
      const Lanes newton = q - off / p.slope;
      const LaneMask usable = (newton > low) & (newton < high);
      const Lanes next = select(usable, newton, (low + high) * 0.5);
      moving &= (next > low) & (next < high);  // the bracket is a single number
      q = select(moving, next, q);
      p = at(branch.up, q);
    }
    const Lanes along = q * along_b_ + p.up * along_a_;  // n·u over its greatest value
    const Lanes nu = along * steepness_;
    const Lanes from_axis = center_r_ * p.inverse;
    // The point relative to the center, along d's horizontal part and along the ray.
    const Lanes level = (from_axis + radius_) * p.up * a_along_d_ - from_axis * nu * u_along_d_;
    const Lanes rise = (from_axis + radius_) * p.up * a_.z - from_axis * nu * axis_.z;
    const Lanes share = (px * d_.x + py * d_.y - level) * inverse_d2_;
    include(span, asked & (share >= -slack_) & (share <= 1 + slack_),
            center_.z + rise + share * d_.z);
  }

  static constexpr int kSteps = 100;  ///< bisection alone ends after 60

  bool exists_ = false;
  Vec3 center_, axis_, d_, a_, b_;
  double center_r_, radius_, low_, high_;
  double steepness_ = 0;  ///< sine U of the angle between u and d: n·u is at most U
  double flat2_ = 0;      ///< 1 − U², the squared ratio of the ellipse's axes
  /// Components of the projected axis' unit direction and of the direction across it.
  double along_b_ = 0, along_a_ = 0, across_b_ = 0, across_a_ = 0;
  double a_along_d_ = 0, u_along_d_ = 0, inverse_d2_ = 0, slack_ = 0;
  Branch branches_[2];
};

}  // namespace kerf
