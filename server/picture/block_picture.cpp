// SPDX-License-Identifier: Apache-2.0
#include "server/picture/block_picture.h"

#include <algorithm>
#include <cmath>

#include "kernel/dexel/stock_column.h"
#include "server/picture/column_ray.h"
#include "server/picture/picture_camera.h"

namespace kerf {
namespace {

// Light and colors of the viewer (web/src/view/stage.ts, web/src/model/materials.ts), linear.
constexpr Vec3 kTowardsKey{-1.0, 0.52, 0.74}, kTowardsFill{0.7, -1.2, 0.55};
constexpr double kKey = 0.95, kFill = 0.3, kSky = 0.42, kGround = 0.16;
constexpr Vec3 kWarm{1, 0.87, 0.7};
constexpr Vec3 kSkin{0.352, 0.15, 0.056}, kCore{0.694, 0.509, 0.296};
/// How far above the surface, in pitches, the ray to the light starts.
constexpr double kShadowLiftPitches = 1.5;
constexpr int kRaysAcross = 2;  ///< per pixel, in each direction

struct Light {
  Vec3 towards_key = normalized(kTowardsKey), towards_fill = normalized(kTowardsFill);
};

/// The light that a surface of a color reflects. `shade`: whether it is in shadow.
Vec3 lit(Vec3 albedo, Vec3 normal, bool shade, const Light& light) {
  const double key = shade ? 0 : kKey * std::max(0.0, dot(normal, light.towards_key));
  const double fill = kFill * std::max(0.0, dot(normal, light.towards_fill));
  const double around = kGround + (kSky - kGround) * 0.5 * (1 + normal.z);
  const Vec3 sum = kWarm * key + Vec3{1, 1, 1} * (fill + around);
  return {albedo.x * sum.x, albedo.y * sum.y, albedo.z * sum.z};
}

bool in_shadow(const DexelSnapshot& field, Vec3 point_mm, Vec3 normal, const Light& light) {
  const Vec3 lifted = point_mm + normal * (kShadowLiftPitches * field.grid().pitch_mm);
  return dot(normal, light.towards_key) > 0 && meets_stock(field, lifted, light.towards_key);
}

/// The color along a ray: of the nearest rod or of the block, or nullopt if it meets neither.
std::optional<Vec3> color_along(const DexelSnapshot& field, const PictureStyle& style, Vec3 eye_mm,
                                Vec3 towards, const Light& light) {
  const auto hit = first_hit(field, eye_mm, towards);
  const PictureRod* rod = nullptr;
  RodHit nearest{hit ? dot(hit->point_mm - eye_mm, towards) : HUGE_VAL, {}};
  for (const PictureRod& one : style.rods) {
    const auto met = meet(one, eye_mm, towards);
    if (!met || met->at_mm >= nearest.at_mm) continue;
    nearest = *met;
    rod = &one;
  }
  if (rod != nullptr) return lit(rod->color, nearest.normal, false, light);
  if (!hit) return std::nullopt;
  const auto painted = style.paint ? style.paint(hit->point_mm) : std::nullopt;
  return lit(painted.value_or(hit->is_cut ? kCore : kSkin), hit->normal,
             in_shadow(field, hit->point_mm, hit->normal, light), light);
}

/// The sRGB curve of a linear value, 0 to 255. Uses square roots, which are equal on any CPU,
/// instead of a power (error < 0.004).
std::uint8_t srgb_of(double linear) {
  const double s1 = std::sqrt(std::clamp(linear, 0.0, 1.0));
  const double s2 = std::sqrt(s1), s3 = std::sqrt(s2);
  const double value =
      0.662002687 * s1 + 0.684122060 * s2 - 0.323583601 * s3 - 0.0225411470 * linear;
  return static_cast<std::uint8_t>(std::clamp(value, 0.0, 1.0) * 255 + 0.5);
}

void render_pixel(const DexelSnapshot& field, const PictureStyle& style,
                  const PictureCamera& camera, const Light& light, int column, int row,
                  Picture& picture) {
  Vec3 sum;
  int hits = 0;
  for (int n = 0; n < kRaysAcross * kRaysAcross; ++n) {
    const double x = column + (n % kRaysAcross + 0.5) / kRaysAcross;
    const double y = row + (n / kRaysAcross + 0.5) / kRaysAcross;
    const Vec3 towards = camera.towards(2 * x / picture.width - 1, 1 - 2 * y / picture.height);
    const auto color = color_along(field, style, camera.eye_mm(), towards, light);
    if (!color) continue;
    sum = sum + *color;
    ++hits;
  }
  if (hits == 0) return;
  const Vec3 mean = sum * (1.0 / hits);
  std::uint8_t* pixel =
      &picture.rgba[4 * (std::size_t(row) * std::size_t(picture.width) + std::size_t(column))];
  pixel[0] = srgb_of(mean.x);
  pixel[1] = srgb_of(mean.y);
  pixel[2] = srgb_of(mean.z);
  pixel[3] = static_cast<std::uint8_t>(255 * hits / (kRaysAcross * kRaysAcross));
}

}  // namespace

std::optional<Picture> render_block(const DexelSnapshot& field, const PictureStyle& style,
                                    const std::function<void(double)>& progress,
                                    const std::stop_token& stop) {
  const int width = style.width, height = style.height;
  Picture picture{width, height, {}};
  picture.rgba.resize(4 * std::size_t(width) * std::size_t(height));
  const PictureCamera camera(stock_bounds(field.stock()), double(width) / height,
                             style.towards_eye);
  const Light light;
  for (int row = 0; row < height; ++row) {
    if (stop.stop_requested()) return std::nullopt;
    for (int column = 0; column < width; ++column) {
      render_pixel(field, style, camera, light, column, row, picture);
    }
    progress(double(row + 1) / height);
  }
  return picture;
}

}  // namespace kerf
