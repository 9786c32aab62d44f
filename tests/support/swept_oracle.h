// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "kernel/math/span.h"
#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf::test {

/// The true motion, computed directly from its definition with libm: tip on a line, axis on the
/// great circle. Shares no code with the kernel.
inline ToolPose true_pose(const ToolPose& from, const ToolPose& to, double t) {
  const Vec3 tip = from.tip_mm * (1 - t) + to.tip_mm * t;
  const Vec3 normal = cross(from.axis, to.axis);
  const double angle = std::atan2(length(normal), dot(from.axis, to.axis));
  if (angle < 1e-15) return {tip, from.axis};
  const double s = std::sin(angle);
  return {tip, from.axis * (std::sin((1 - t) * angle) / s) + to.axis * (std::sin(t * angle) / s)};
}

/// Returns a convex function of a point that is negative inside an upright piece at the origin and
/// zero on its surface. It is not a Euclidean distance.
inline double outside(const ToolPiece& piece, double radial, double height) {
  if (const auto* b = std::get_if<BallPiece>(&piece)) {
    return std::sqrt(radial * radial + (height - b->center_mm) * (height - b->center_mm)) -
           b->radius_mm;
  }
  if (const auto* a = std::get_if<ArcPiece>(&piece)) {
    // The distance from the disc of radius center_r, or, if the center is beyond the axis, from the
    // circle's center in the half-plane of the point. Both are convex.
    const double across = std::max(radial - a->center_r_mm, 0.0);
    const double along = height - a->center_z_mm;
    return std::max({std::sqrt(across * across + along * along) - a->radius_mm, a->z0_mm - height,
                     height - a->z1_mm});
  }
  const auto& f = std::get<FrustumPiece>(piece);
  const double slope = (f.r1_mm - f.r0_mm) / (f.z1_mm - f.z0_mm);
  const double side =
      (radial - f.r0_mm - slope * (height - f.z0_mm)) / std::sqrt(1 + slope * slope);
  return std::max({side, f.z0_mm - height, height - f.z1_mm});
}

inline double outside(const ToolPiece& piece, const ToolPose& pose, Vec3 point) {
  const Vec3 p = point - pose.tip_mm;
  const double h = dot(p, pose.axis);
  return outside(piece, length(p - pose.axis * h), h);
}

/// Returns the heights at which the vertical line through (x, y) is inside a piece at one pose, by
/// bisection of a convex function. Its slope is 1 at most, so a value above the length of an
/// interval that holds the least one shows that the line is outside.
inline Span static_span(const ToolPiece& piece, const ToolPose& pose, double x, double y,
                        double z_lo, double z_hi) {
  const auto f = [&](double z) { return outside(piece, pose, {x, y, z}); };
  double a = z_lo, b = z_hi;
  std::optional<double> inside;
  for (int i = 0; i < 120 && !inside; ++i) {
    const double m1 = a + (b - a) * 0.382, m2 = b - (b - a) * 0.382;
    const double f1 = f(m1), f2 = f(m2);
    if (std::min(f1, f2) > b - a) return {};
    if (f1 <= 0) inside = m1;
    if (f2 <= 0) inside = m2;
    if (f1 < f2) {
      b = m2;
    } else {
      a = m1;
    }
  }
  const double inner = inside.value_or((a + b) / 2);
  if (!(f(inner) <= 0)) return {};
  const auto edge = [&](double in, double out) {
    if (f(out) <= 0) return out;
    for (int i = 0; i < 60; ++i) {
      const double m = (in + out) / 2;
      (f(m) <= 0 ? in : out) = m;
    }
    return in;
  };
  return {edge(inner, z_lo), edge(inner, z_hi)};
}

/// Returns the heights that a piece sweeps along the true motion at (x, y), between z_lo and z_hi:
/// dense poses, then a golden section around the best one. The slow, simple reference for the
/// kernel.
inline Span swept_span(const ToolPiece& piece, const ToolPose& from, const ToolPose& to, double x,
                       double y, double z_lo, double z_hi, int samples = 64) {
  const auto at = [&](double t) {
    return static_span(piece, true_pose(from, to, t), x, y, z_lo, z_hi);
  };
  int best_lo = -1, best_hi = -1;
  Span span;
  for (int i = 0; i <= samples; ++i) {
    const Span s = at(double(i) / samples);
    if (s.lo < span.lo) span.lo = s.lo, best_lo = i;
    if (s.hi > span.hi) span.hi = s.hi, best_hi = i;
  }
  const auto refine = [&](int best, auto value) {
    double a = std::max(0, best - 1) / double(samples);
    double b = std::min(samples, best + 1) / double(samples);
    double found = value(double(best) / samples);
    for (int i = 0; i < 50; ++i) {
      const double m1 = a + (b - a) * 0.382, m2 = b - (b - a) * 0.382;
      const double f1 = value(m1), f2 = value(m2);
      found = std::min({found, f1, f2});
      if (f1 < f2) {
        b = m2;
      } else {
        a = m1;
      }
    }
    return found;
  };
  if (best_lo >= 0) span.lo = refine(best_lo, [&](double t) { return at(t).lo; });
  if (best_hi >= 0) span.hi = -refine(best_hi, [&](double t) { return -at(t).hi; });
  return span;
}

/// Returns the least value of `outside` at a point over the whole motion, negative inside the true
/// sweep.
inline double swept_outside(const ToolPiece& piece, const ToolPose& from, const ToolPose& to,
                            Vec3 point, int samples = 400) {
  double best = std::numeric_limits<double>::infinity();
  int at = 0;
  for (int i = 0; i <= samples; ++i) {
    const double d = outside(piece, true_pose(from, to, double(i) / samples), point);
    if (d < best) best = d, at = i;
  }
  double a = std::max(0, at - 1) / double(samples), b = std::min(samples, at + 1) / double(samples);
  for (int i = 0; i < 60; ++i) {
    const double m1 = a + (b - a) * 0.382, m2 = b - (b - a) * 0.382;
    const double f1 = outside(piece, true_pose(from, to, m1), point);
    const double f2 = outside(piece, true_pose(from, to, m2), point);
    best = std::min({best, f1, f2});
    if (f1 < f2) {
      b = m2;
    } else {
      a = m1;
    }
  }
  return best;
}

}  // namespace kerf::test
