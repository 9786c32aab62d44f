#pragma once

#include <cmath>

#include "kernel/math/tolerance.h"
#include "kernel/math/vec3.h"
#include "kernel/sweep/column_row.h"
#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// A truncated cone halfway through a small turn, in the frame that makes its envelope simple: k
/// the axis of the turn, u the tool's axis, w = k × u the way the turn moves points of the axis. A
/// material point p of the middle pose stands at p + s V(p), −1/2 <= s <= 1/2, with V(p) = v + Ω ×
/// (p − tip), Ω = omega k (kernel/README.md, "The tight model").
struct TurningFrustum {
  Vec3 base;  ///< centre of the lower disc at the middle pose
  Vec3 w, k, u;
  double height, r0, slope;
  double omega;             ///< chord of the turn: 2 sin(turn / 2)
  double va, vb, vc;        ///< velocity of `base` along w, k, u
  double straightening_mm;  ///< farthest that a straight way ends from the true end pose

  TurningFrustum(const FrustumPiece& piece, const ToolPose& from, const ToolPose& to);
};

/// Newton steps taken towards a contact. They start from the solution for a translation, within a
/// few parts in a hundred, and the number of good digits doubles each time.
inline constexpr int kContactSteps = 5;

/// A point of the moving surface and how it moves with two unknowns, in world axes, relative to
/// TurningFrustum::base.
struct ContactPoint {
  Vec3 at, by_first, by_second;

  struct Step {
    double first, second;
  };
  /// Newton's step towards at.xy = (x, y).
  Step towards(double x, double y) const {
    const double inverse = 1 / (by_first.x * by_second.y - by_first.y * by_second.x);
    const double ex = x - at.x, ey = y - at.y;
    return {(ex * by_second.y - ey * by_second.x) * inverse,
            (by_first.x * ey - by_first.y * ex) * inverse};
  }
  /// Whether the point lies on the ray, as nearly as the model knows where its ways end: a contact
  /// just beyond the end of one sub-motion and just before the start of the next must be claimed by
  /// one of them.
  bool meets(double x, double y, double straightening_mm) const {
    const double allowed = straightening_mm + kContactEpsilonMm;
    return (std::abs(x - at.x) <= allowed) & (std::abs(y - at.y) <= allowed);
  }
};

inline double clamp(double v, double lo, double hi) {
  const double above = v < lo ? lo : v;
  return above > hi ? hi : above;
}

inline Vec3 in_world(const TurningFrustum& f, double a, double b, double c) {
  return {f.w.x * a + f.k.x * b + f.u.x * c, f.w.y * a + f.k.y * b + f.u.y * c,
          f.w.z * a + f.k.z * b + f.u.z * c};
}

/// The side's contact at height l and share s: the radial direction e with (e − slope u)·V = 0,
/// which is e·(X, Y) = slope vc in the (w, k) plane, X = va + l omega + slope omega r, Y = vb.
/// `sign` picks one of the two.
struct SideContact : ContactPoint {
  bool exists;

  SideContact(const TurningFrustum& f, double sign, double l, double s) : ContactPoint{} {
    const double r = f.r0 + f.slope * l;
    const double x = f.va + (l + f.slope * r) * f.omega, y = f.vb;
    const double n = std::sqrt(x * x + y * y);
    const double cosine = f.slope * f.vc / n;
    exists = std::abs(cosine) <= 1;
    const double c = clamp(cosine, -1, 1);
    const double sine = sign * std::sqrt(1 - c * c);
    const double ew = (c * x - sine * y) / n, ek = (c * y + sine * x) / n;
    // How e turns with l, from the derivative of its equation.
    const double turn = ew * f.omega * (1 + f.slope * f.slope) / (n * sine);
    const double va = f.va + l * f.omega, vc = f.vc - f.omega * r * ew;
    const double dw = f.slope * ew - r * turn * ek, dk = f.slope * ek + r * turn * ew;
    at = in_world(f, r * ew + s * va, r * ek + s * f.vb, l + s * vc);
    by_first = in_world(f, dw + s * f.omega, dk, 1 - s * f.omega * dw);
    by_second = in_world(f, va, f.vb, vc);
  }
};

/// A rim's point in the radial direction (ew, ek) at share s; unknowns: the angle of the direction,
/// and s.
struct RimContact : ContactPoint {
  RimContact(const TurningFrustum& f, double height, double radius, double ew, double ek, double s)
      : ContactPoint{} {
    const double va = f.va + height * f.omega, vc = f.vc - f.omega * radius * ew;
    at = in_world(f, radius * ew + s * va, radius * ek + s * f.vb, height + s * vc);
    by_first = in_world(f, -radius * ek, radius * ew, s * f.omega * radius * ek);
    by_second = in_world(f, va, f.vb, vc);
  }
};

/// Where the search for a rim's contact starts: one of the two contacts that a translation with the
/// velocity of the rim's centre would have (RayPipe, centred on the middle of its way), or the
/// nearest point of the rim where the ray passes by
/// (`sign` +1, −1); or where the ray crosses the plane of the rim (`sign` 0), for a rim that tilts
/// about a centre nearly at rest, which no translation resembles. The radial direction is not
/// normalised.
struct RimStart {
  double ew, ek, s;

  RimStart(const TurningFrustum& f, double height, double radius, double sign, double x, double y) {
    const double va = f.va + height * f.omega;
    const Vec3 d = in_world(f, va, f.vb, f.vc);
    const double px = x - f.u.x * height, py = y - f.u.y * height;
    const double inverse_n = 1 / (f.u.z * f.u.z + f.vc * f.vc);
    const double alpha = (px * f.u.x + py * f.u.y) * inverse_n;
    const double s0 = alpha * f.vc, w0 = -alpha * f.u.z;
    const Vec3 q0{px - s0 * d.x, py - s0 * d.y, w0 - s0 * d.z};
    const Vec3 g{-f.u.z * d.x, -f.u.z * d.y, f.vc - f.u.z * d.z};
    const double gg = dot(g, g), b = dot(q0, g);
    const double inside = b * b - gg * (dot(q0, q0) - radius * radius);
    const double tau = sign == 0 ? 0 : (sign * std::sqrt(inside > 0 ? inside : 0) - b) / gg;
    const Vec3 q{q0.x + tau * g.x, q0.y + tau * g.y, q0.z + tau * g.z};
    ew = dot(q, f.w);
    ek = dot(q, f.k);
    s = clamp(s0 + tau * f.u.z, -0.5, 0.5);
  }
};

/// Widens each column's range by the contacts of the turning frustum's envelope with it: both
/// sides, both rims.
void include_turning_contacts(ColumnRow& row, const TurningFrustum& f, const FrustumPiece& piece);

}  // namespace kerf
