// SPDX-License-Identifier: Apache-2.0
// Fig. 15: a songbird on a branch, as the maximum of the heights of its parts.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/paper/examples.h"

namespace kerf::paper {
namespace {

constexpr double kStepMm = 0.3, kBallMm = 1.2, kGroundMm = -6.5;
constexpr double kWidthMm = 70, kHeightMm = 56;

/// A rounded part: `edge_mm` high at its outline, `top_mm` in its middle.
double dome(double share, double edge_mm, double top_mm) {
  return share >= 1 ? 0 : edge_mm + (top_mm - edge_mm) * std::sqrt(1 - share * share);
}

/// Distances along and across the axis of an ellipse that is turned, in its semi-axes.
struct Ellipse {
  double x, y, along, across, degrees;
  Vec3 local(double px, double py) const {
    const double a = degrees * std::numbers::pi / 180;
    const double dx = px - x, dy = py - y;
    return {(dx * std::cos(a) + dy * std::sin(a)) / along,
            (-dx * std::sin(a) + dy * std::cos(a)) / across, 0};
  }
  double share(double px, double py) const { return length(local(px, py)); }
};

/// Distance from a limb whose radius changes from end to end, in radii.
double limb(double px, double py, Vec3 a, Vec3 b, double ra, double rb) {
  const Vec3 along = b - a, arm = Vec3{px, py, 0} - a;
  const double s = std::clamp(dot(arm, along) / dot(along, along), 0.0, 1.0);
  return length(arm - along * s) / (ra + (rb - ra) * s);
}

double wing(double x, double y) {
  constexpr Ellipse kWing{41, 27, 14.5, 6.5, -33};
  const Vec3 at = kWing.local(x, y);
  double height = dome(length(at), 4.6, 6);
  if (height == 0) return 0;
  // Scales of the shoulder, which turn into long feathers that fan out from it.
  const double feather = std::clamp(2.5 * (at.x + 0.5), 0.0, 1.0);
  return height + (1 - feather) * 0.3 * std::cos(13 * at.x) * std::cos(11 * at.y) +
         feather * 0.5 * std::abs(std::sin(9 * (at.y - 0.25) / (1.15 - 0.35 * at.x)));
}

double tail(double x, double y) {
  double height = 0;
  for (int n = 0; n < 3; ++n) {
    const double spread = 2.6 * (n - 1);
    const double q = limb(x, y, {49, 19.5, 0}, {64 + 0.4 * spread, 8 + spread, 0}, 2.6, 1.7);
    height = std::max(height, dome(q, 1.6, 3.2 - 0.3 * std::abs(n - 1)));
  }
  return height;
}

double head(double x, double y) {
  constexpr double kEyeX = 19.6, kEyeY = 41.2;
  const double neck = limb(x, y, {23, 39, 0}, {34, 30, 0}, 7, 10);
  const double beak = limb(x, y, {18, 39.6, 0}, {8.5, 37.8, 0}, 3.2, 0.35);
  const bool gape = std::abs(y - 37.9 - 0.11 * (x - 8.5)) < 0.3 && x < 14.8;
  const double height = std::max({dome(std::hypot(x - 22.5, y - 39.5) / 7.6, 1.5, 5.5),
                                  dome(neck, 1.3, 4.9), dome(beak, 0.8, 3.6) - (gape ? 0.6 : 0)});
  const double eye = std::hypot(x - kEyeX, y - kEyeY);
  const double socket = eye < 2 ? 1.1 * std::sqrt(1 - eye * eye / 4) : 0;
  return height - socket + (eye < 1.15 ? 1.9 * std::sqrt(1 - eye * eye / 1.33) : 0);
}

double branch(double x, double y) {
  const double bark = 0.25 * std::sin(1.1 * x + 3 * std::sin(0.35 * y));
  const double wood = limb(x, y, {3, 8.5, 0}, {67, 12.5 + 1.5 * std::sin(0.12 * x), 0}, 2.6, 1.5);
  double height = wood < 1 ? dome(wood, 0.9, 2.6) + bark * (1 - wood) : 0;
  constexpr Ellipse kLeaves[] = {
      {11, 17.5, 7, 2.9, 62}, {57, 21, 7, 2.9, 48}, {62, 30, 6, 2.4, 78}};
  for (const Ellipse& leaf : kLeaves) {
    const Vec3 at = leaf.local(x, y);
    const double rib =
        0.7 * std::exp(-30 * at.y * at.y) + 0.3 * std::sin(16 * (at.x - 0.9 * std::abs(at.y)));
    const double pointed = std::hypot(at.x, at.y * (1 + 0.6 * at.x * at.x));
    height = std::max(height, pointed < 1 ? dome(pointed, 0.7, 1.9) + 0.4 * rib : 0);
  }
  for (const double leg : {33.0, 38.5}) {
    height = std::max(height, dome(limb(x, y, {leg, 19, 0}, {leg - 1.5, 11.5, 0}, 0.9, 0.8), 1, 3));
    for (const double toe : {-2.2, 0.0, 2.2}) {
      const double q = limb(x, y, {leg - 1.5, 11.8, 0}, {leg - 1.5 + toe, 8.6, 0}, 0.8, 0.6);
      height = std::max(height, dome(q, 1.6, 3.4));
    }
  }
  return height;
}

}  // namespace

double bird_height(double x, double y) {
  constexpr Ellipse kBody{36, 28, 17, 10.5, -34};
  const Vec3 at = kBody.local(x, y);
  const double plumage = 0.14 * std::cos(24 * at.x) * std::cos(15 * at.y);
  const double body = dome(length(at), 1.5, 5.4);
  return std::max(
      {body > 0 ? body + plumage : 0, head(x, y), wing(x, y), tail(x, y), branch(x, y)});
}

Example bird() {
  Example one{{}, BallShape{kBallMm, 16}, {}, 60};
  one.settings.stock = BoxStock{{0, 0, -10}, {kWidthMm, kHeightMm, 0}};
  one.settings.pitch_mm = kStepMm;
  // The lowest tip at which the ball stays above the relief.
  const auto tip = [](double x, double y) {
    double z = -1e9;
    for (int n = -2; n <= 2; ++n) {
      for (int m = -2; m <= 2; ++m) {
        const double dx = n * kStepMm, dy = m * kStepMm, r = kBallMm / 2;
        const double under = r * r - dx * dx - dy * dy;
        if (under < 0) continue;
        z = std::max(z, kGroundMm + bird_height(x + dx, y + dy) + std::sqrt(under) - r);
      }
    }
    return z;
  };
  const int rows = int(kHeightMm / kStepMm), places = int(kWidthMm / kStepMm) + 1;
  for (int row = 0; row <= rows; ++row) {
    for (int n = 0; n < places; ++n) {
      const double x = (row % 2 == 0 ? n : places - 1 - n) * kStepMm, y = row * kStepMm;
      one.path.push_back({{x, y, tip(x, y)}, {0, 0, 1}});
    }
  }
  return one;
}

}  // namespace kerf::paper
