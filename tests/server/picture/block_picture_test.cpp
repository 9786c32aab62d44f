// SPDX-License-Identifier: Apache-2.0
#include "server/picture/block_picture.h"

#include <png.h>

#include "kernel/sculpture.h"
#include "server/picture/picture_camera.h"
#include "server/picture/png_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::block_picture_test {
namespace {

constexpr auto kNoProgress = [](double) {};

Sculpture block_of(const BoxStock& box) {
  return *Sculpture::create({.stock = box, .pitch_mm = 0.25});
}

Sculpture grooved() {
  auto block = block_of({{0, 0, 0}, {16, 12, 6}});
  block.apply(DefineTool{1, *make_tool(BallShape{4, 40})}).value();
  block.apply(MoveTool{1, {{2, 6, 4}, {0, 0, 1}}, {{14, 6, 4}, {0, 0, 1}}, 0, false}).value();
  return block;
}

Picture render(Sculpture block, int width, int height) {
  return render_block(block.snapshot(), {.width = width, .height = height}, kNoProgress, {})
      .value();
}

std::uint64_t hash_of(const Picture& picture) {
  std::uint64_t hash = 14695981039346656037U;
  for (const std::uint8_t byte : picture.rgba) hash = (hash ^ byte) * 1099511628211U;
  return hash;
}

/// Returns the pixel that shows a point, in pixels from the lower left.
std::pair<double, double> project(Vec3 at, const PictureCamera& camera, const Picture& picture) {
  const Vec3 back = normalized({-0.45, -1, 1.42});
  const Vec3 side = normalized(cross({0, 0, 1}, back)), up = cross(back, side);
  const Vec3 arm = at - camera.eye_mm();
  const double focal = 0.5 * picture.height / std::tan(15 * M_PI / 180);  // vertical field of view
                                                                          // of 30 degrees
  const double depth = -dot(arm, back);
  return {0.5 * picture.width + focal * dot(arm, side) / depth,
          0.5 * picture.height + focal * dot(arm, up) / depth};
}

/// Area of the convex hull of points (Andrew's monotone chain).
double hull_area(std::vector<std::pair<double, double>> points) {
  std::ranges::sort(points);
  std::vector<std::pair<double, double>> hull;
  const auto turns_left = [&](const auto& c) {
    const auto &a = hull[hull.size() - 2], &b = hull.back();
    return (b.first - a.first) * (c.second - a.second) >
           (b.second - a.second) * (c.first - a.first);
  };
  for (int round = 0; round < 2; ++round, std::ranges::reverse(points)) {
    const std::size_t begin = hull.size() + 1;
    for (const auto& point : points) {
      while (hull.size() > begin && !turns_left(point)) hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
  }
  double twice = 0;
  for (std::size_t n = 0; n < hull.size(); ++n) {
    const auto &a = hull[n], &b = hull[(n + 1) % hull.size()];
    twice += a.first * b.second - a.second * b.first;
  }
  return twice / 2;
}

TEST(BlockPicture, ABoxCoversTheHullOfItsCorners) {
  const std::pair<BoxStock, std::pair<int, int>> cases[] = {
      {{{-5, 3, -8}, {15, 13, -2}}, {240, 180}},
      {{{0, 0, 0}, {4, 4, 20}}, {180, 120}},   // a tower
      {{{0, 0, 0}, {30, 6, 1}}, {120, 160}}};  // a slat, in an upright picture
  for (const auto& [box, size] : cases) {
    const Picture picture = render(block_of(box), size.first, size.second);
    const PictureCamera camera(box, double(size.first) / size.second, kFromFrontLeft);
    std::vector<std::pair<double, double>> corners;
    for (int n = 0; n < 8; ++n) {
      corners.push_back(
          project({n & 1 ? box.max_mm.x : box.min_mm.x, n & 2 ? box.max_mm.y : box.min_mm.y,
                   n & 4 ? box.max_mm.z : box.min_mm.z},
                  camera, picture));
    }
    double covered = 0;
    for (std::size_t n = 3; n < picture.rgba.size(); n += 4) covered += picture.rgba[n] / 255.0;
    EXPECT_NEAR(covered / hull_area(corners), 1, 0.004) << size.first;
    for (const auto& [x, y] : corners) {
      EXPECT_TRUE(x > 0 && y > 0 && x < size.first && y < size.second) << x << " " << y;
    }
  }
}

TEST(BlockPicture, CutsAreLighterThanTheOriginalSurface) {
  const Picture whole = render(block_of({{0, 0, 0}, {16, 12, 6}}), 64, 48);
  const Picture cut = render(grooved(), 64, 48);
  int lighter = 0, changed = 0;
  for (std::size_t n = 0; n < whole.rgba.size(); n += 4) {
    if (whole.rgba[n] == cut.rgba[n]) continue;
    ++changed;
    lighter += cut.rgba[n] > whole.rgba[n];
  }
  EXPECT_GT(changed, 100);
  EXPECT_GT(lighter, changed * 2 / 3) << "but for the shadow in the groove";
}

TEST(BlockPicture, EqualBlocksGiveEqualBytes) {
  EXPECT_EQ(hash_of(render(grooved(), 32, 24)), 6108917262980036935U);
}

TEST(BlockPicture, ShowsTheRequestedSideInItsColors) {
  // Paint everything behind the middle red: seen from the back it is in front, at the bottom.
  auto block = block_of({{0, 0, 0}, {16, 12, 6}});
  PictureStyle style{.width = 48, .height = 36};
  style.paint = [](Vec3 at) { return at.y > 6 ? std::optional(Vec3{1, 0, 0}) : std::nullopt; };
  const auto red_rows = [&](Vec3 towards_eye) {
    style.towards_eye = towards_eye;
    const Picture picture = render_block(block.snapshot(), style, kNoProgress, {}).value();
    double sum = 0, count = 0;
    for (std::size_t n = 0; n < picture.rgba.size(); n += 4) {
      if (picture.rgba[n] < 40 || picture.rgba[n + 1] > 0 || picture.rgba[n + 3] < 255) continue;
      sum += double(n / 4 / 48);
      ++count;
    }
    EXPECT_GT(count, 50);
    return sum / count;
  };
  EXPECT_LT(red_rows(kFromFrontLeft), 17);
  EXPECT_LT(red_rows(kFromAbove), 18);
  EXPECT_GT(red_rows(kFromBackRight), 19);
}

TEST(BlockPicture, StopsAndReportsItsProgress) {
  auto block = grooved();
  std::stop_source stop;
  std::vector<double> shares;
  const auto progress = [&](double share) {
    shares.push_back(share);
    if (shares.size() == 3) stop.request_stop();
  };
  EXPECT_FALSE(
      render_block(block.snapshot(), {.width = 32, .height = 24}, progress, stop.get_token()));
  EXPECT_EQ(shares.size(), 3U);
  EXPECT_TRUE(render_block(block.snapshot(), {.width = 32, .height = 24}, progress, {}));
  EXPECT_TRUE(std::ranges::is_sorted(shares.begin() + 3, shares.end()));
  EXPECT_EQ(shares.back(), 1);
}

TEST(PngFile, RoundTrips) {
  const test::TemporaryFolder folder;
  const Picture picture = render(grooved(), 40, 30);
  ASSERT_TRUE(write_png(folder.path() / "a.png", picture));
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&image, (folder.path() / "a.png").c_str()), 0);
  EXPECT_EQ(image.width, 40U);
  EXPECT_EQ(image.height, 30U);
  EXPECT_EQ(image.format, unsigned{PNG_FORMAT_RGBA});
  std::vector<std::uint8_t> rgba(PNG_IMAGE_SIZE(image));
  ASSERT_NE(png_image_finish_read(&image, nullptr, rgba.data(), 0, nullptr), 0);
  EXPECT_EQ(rgba, picture.rgba);
  EXPECT_FALSE(write_png(folder.path() / "no" / "a.png", picture));
  std::ifstream file(folder.path() / "a.png", std::ios::binary);
  EXPECT_EQ(png_bytes(picture).value(), std::string(std::istreambuf_iterator<char>(file), {}));
}

}  // namespace
}  // namespace kerf::block_picture_test
