// SPDX-License-Identifier: Apache-2.0
#include "kernel/math/rotation.h"

#include <cmath>

namespace kerf {
namespace {

// Returns asin x for 0 <= x <= 1/2 by its Taylor series. Each term is at most a quarter of the one
// before, so 26 of them reach rounding.
double asin_series(double x) {
  const double x2 = x * x;
  double term = x;
  double sum = x;
  for (int k = 1; k < 27; ++k) {
    term *= x2 * (2.0 * k - 1) / (2.0 * k);
    sum += term / (2.0 * k + 1);
  }
  return sum;
}

}  // namespace

SinCos sin_cos(double angle_rad) {
  // Taylor at an eighth of the angle (below 0.4), then three doublings.
  const double x = angle_rad / 8;
  const double x2 = x * x;
  double sin = 0;
  double versine = 0;  // 1 - cos, which keeps its digits where cos loses them
  double term = x;
  for (int k = 1; k <= 17; k += 2) {
    sin += term;
    term *= -x2 / ((k + 1.0) * (k + 2.0));
  }
  term = x2 / 2;
  for (int k = 2; k <= 18; k += 2) {
    versine += term;
    term *= -x2 / ((k + 1.0) * (k + 2.0));
  }
  for (int i = 0; i < 3; ++i) {
    const double doubled = 2 * sin * (1 - versine);
    versine = 2 * sin * sin;
    sin = doubled;
  }
  return {sin, 1 - versine};
}

double angle_between(Vec3 a, Vec3 b) {
  if (a == b) return 0;
  // Half the chord is sin(angle / 2). Beyond a right angle the supplement is used. Halving the
  // angle once more brings it into the range of the series.
  const bool obtuse = dot(a, b) < 0;
  const double half_chord = length(obtuse ? a + b : a - b) / 2;  // sin(angle/2) <= sin 45 deg
  const double c = std::sqrt(1 - half_chord * half_chord);
  const double quarter = half_chord / std::sqrt(2 * (1 + c));  // sin(angle / 4)
  const double angle = 4 * asin_series(quarter);
  constexpr double kPi = 3.14159265358979323846;
  return obtuse ? kPi - angle : angle;
}

Vec3 great_circle(Vec3 a, Vec3 b, double angle_rad, double share) {
  if (share <= 0) return a;
  if (share >= 1) return b;
  // Basis of the plane of a and b: a, and the perpendicular to it on b's side.
  const Vec3 side = cross(cross(a, b), a);
  const double n = length(side);
  if (n <= 0) return a;
  const SinCos sc = sin_cos(angle_rad * share);
  return normalized(a * sc.cos + side * (sc.sin / n));
}

Vec3 any_perpendicular(Vec3 a) {
  const double x = std::abs(a.x), y = std::abs(a.y), z = std::abs(a.z);
  const Vec3 least = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return normalized(cross(a, least));
}

}  // namespace kerf
