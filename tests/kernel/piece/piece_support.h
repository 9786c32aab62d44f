// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "kernel/math/lanes.h"
#include "kernel/math/vec3.h"

namespace kerf::test {

/// A point of the half-plane: distance from the axis, height above the tip.
struct HalfPoint {
  double rho, h;
};

inline double between(std::mt19937& random, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}

/// Returns the radius at a height by bisection of a predicate for the inside of a body,
/// independently of every formula for a radius. −1 if not even the axis is inside.
template <class Inside>
double radius_by_bisection(const Inside& inside, double h, double beyond) {
  if (!inside(HalfPoint{0, h})) return -1;
  double in = 0, out = beyond;
  for (int i = 0; i < 200; ++i) {
    const double middle = (in + out) / 2;
    (inside(HalfPoint{middle, h}) ? in : out) = middle;
  }
  return in;
}

/// Returns the distance of a point from the nearest of many points.
inline double nearest_of(const std::vector<HalfPoint>& points, HalfPoint p) {
  double least = std::numeric_limits<double>::infinity();
  for (const HalfPoint& q : points) least = std::min(least, std::hypot(p.rho - q.rho, p.h - q.h));
  return least;
}

/// Returns whether a function on lanes gives the bits of the scalar function for eight values.
template <class OnLanes, class Scalar>
bool lanes_match_scalars(const double (&values)[kLanes], const OnLanes& on_lanes,
                         const Scalar& scalar) {
  Lanes v;
  for (int i = 0; i < kLanes; ++i) v.set(i, values[i]);
  const Lanes result = on_lanes(v);
  for (int i = 0; i < kLanes; ++i) {
    const double expected = scalar(values[i]);
    if (!(result[i] == expected || (std::isnan(result[i]) && std::isnan(expected)))) return false;
  }
  return true;
}

}  // namespace kerf::test
