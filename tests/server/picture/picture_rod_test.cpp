// SPDX-License-Identifier: Apache-2.0
#include "server/picture/picture_rod.h"

#include "kernel/sculpture.h"
#include "server/picture/block_picture.h"
#include "server/picture/picture_camera.h"
#include "tests/support/test.h"

namespace kerf::picture_rod_test {
namespace {

/// A signed value for a point, like a distance: negative inside the rod.
double outside(const PictureRod& rod, Vec3 at) {
  const double height = length(rod.to_mm - rod.from_mm);
  const Vec3 axis = normalized(rod.to_mm - rod.from_mm), arm = at - rod.from_mm;
  const double h = dot(arm, axis);
  const double radius = rod.from_radius_mm + (rod.to_radius_mm - rod.from_radius_mm) * h / height;
  return std::max({-h, h - height, length(arm - axis * h) - radius});
}

TEST(PictureRod, HitAgreesWithAFineMarch) {
  std::mt19937_64 random(1);
  const test::Uniform in(random);
  const auto point = [&](double r) { return Vec3{in(-r, r), in(-r, r), in(-r, r)}; };
  int met = 0;
  constexpr double kStep = 1e-3;
  for (int n = 0; n < 300; ++n) {
    const PictureRod rod{
        point(2), point(2), n % 3 == 0 ? 0 : in(0, 2), n % 3 == 1 ? 0 : in(0, 2), {}};
    const Vec3 eye = normalized(point(1)) * 12;
    const Vec3 towards = normalized(point(2) - eye);
    const auto hit = meet(rod, eye, towards);
    double first = -1;
    for (double at = 0; at < 24 && first < 0; at += kStep) {
      if (outside(rod, eye + towards * at) < -kStep) first = at;
    }
    if (first >= 0) {
      ASSERT_TRUE(hit) << n;
      EXPECT_LE(hit->at_mm, first) << n;
      ++met;
    }
    if (!hit) continue;
    EXPECT_NEAR(outside(rod, eye + towards * hit->at_mm), 0, 1e-9) << n;
    EXPECT_NEAR(length(hit->normal), 1, 1e-12) << n;
    EXPECT_LT(dot(hit->normal, towards), 0) << n;
  }
  EXPECT_GT(met, 60);
}

TEST(PictureRod, IsDrawnInFrontOfTheBlockAndHiddenBehindIt) {
  auto block = Sculpture::create({.stock = BoxStock{{0, 0, 0}, {16, 12, 6}}}).value();
  const auto red_pixels = [&](Vec3 from, Vec3 to) {
    PictureStyle style{.width = 64, .height = 48, .rods = {{from, to, 0.5, 0.5, {1, 0, 0}}}};
    const Picture picture = render_block(block.snapshot(), style, [](double) {}, {}).value();
    int red = 0;
    for (std::size_t n = 0; n < picture.rgba.size(); n += 4) {
      red += picture.rgba[n + 3] == 255 && picture.rgba[n] > 60 && picture.rgba[n + 1] == 0;
    }
    return red;
  };
  EXPECT_GT(red_pixels({2, 6, 8}, {14, 6, 8}), 60) << "above the block";
  EXPECT_EQ(red_pixels({2, 6, 3}, {14, 6, 3}), 0) << "in the block";
  EXPECT_EQ(red_pixels({4, 14, -8}, {12, 14, -8}), 0) << "behind the block";
}

}  // namespace
}  // namespace kerf::picture_rod_test
