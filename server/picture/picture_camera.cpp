// SPDX-License-Identifier: Apache-2.0
#include "server/picture/picture_camera.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

constexpr double kTanHalfView = 0.2679491924311227;  ///< of 15 degrees
constexpr double kMargin = 1.03;

/// Smallest distance from the box's center at which all of its corners are in view.
double fit_distance(Vec3 half, Vec3 back, Vec3 side, Vec3 up, double tan_x, double tan_y) {
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 arm{(corner & 1) ? half.x : -half.x, (corner & 2) ? half.y : -half.y,
                   (corner & 4) ? half.z : -half.z};
    distance = std::max({distance, dot(arm, back) + std::abs(dot(arm, side)) / tan_x,
                         dot(arm, back) + std::abs(dot(arm, up)) / tan_y});
  }
  return distance;
}

}  // namespace

PictureCamera::PictureCamera(const BoxStock& box, double aspect, Vec3 towards_eye) {
  const Vec3 back = normalized(towards_eye);
  const Vec3 side = normalized(cross({0, 0, 1}, back));
  const Vec3 up = cross(back, side);
  const double tan_x = kTanHalfView * aspect, tan_y = kTanHalfView;
  const Vec3 half = (box.max_mm - box.min_mm) * 0.5;
  const double distance = kMargin * fit_distance(half, back, side, up, tan_x, tan_y);
  eye_mm_ = (box.min_mm + box.max_mm) * 0.5 + back * distance;
  forward_ = -back;
  side_ = side * tan_x;
  up_ = up * tan_y;
}

Vec3 PictureCamera::towards(double x, double y) const {
  return normalized(forward_ + side_ * x + up_ * y);
}

}  // namespace kerf
