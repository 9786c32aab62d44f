#include "kernel/dexel/stock_column.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {
namespace {

constexpr int kDepthBits = 30;
constexpr double kSideColumnsMax = 0x7fffff00;

BoxStock bounds(const StockShape& stock) {
  if (const auto* box = std::get_if<BoxStock>(&stock)) return *box;
  const auto& c = std::get<CylinderStock>(stock);
  return {{c.center_x_mm - c.radius_mm, c.center_y_mm - c.radius_mm, c.min_z_mm},
          {c.center_x_mm + c.radius_mm, c.center_y_mm + c.radius_mm, c.max_z_mm}};
}

/// The chord of a ray across an upright cylinder, `aside_mm` from the axis. `center` is the depth
/// of the axis.
Dexel chord(const CylinderStock& c, const DexelGrid& grid, double aside_mm, double center_mm) {
  const double half2 = c.radius_mm * c.radius_mm - aside_mm * aside_mm;
  if (!(half2 > 0)) return {};
  const double half = std::sqrt(half2);
  const auto depth = [&](double mm) {
    const double quanta = (mm - grid.origin_mm.z) / grid.z_quantum_mm;
    return static_cast<std::int32_t>(std::clamp(quanta, 0.0, double(grid.height_quanta)) + 0.5);
  };
  return {depth(center_mm - half), depth(center_mm + half)};
}

double columns(double size_mm, double pitch_mm) {
  return std::max(1.0, std::floor(size_mm / pitch_mm + 0.5));
}

}  // namespace

Dexel stock_column(const StockShape& stock, const DexelGrid& grid, std::int32_t i, std::int32_t j) {
  const auto* c = std::get_if<CylinderStock>(&stock);
  if (c == nullptr) return {0, grid.height_quanta};
  switch (grid.axis) {
    case RayAxis::kX:
      return chord(*c, grid, grid.x_mm(i) - c->center_y_mm, c->center_x_mm);
    case RayAxis::kY:
      return chord(*c, grid, grid.y_mm(j) - c->center_x_mm, c->center_y_mm);
    case RayAxis::kZ:
      break;
  }
  const double dx = grid.x_mm(i) - c->center_x_mm;
  const double dy = grid.y_mm(j) - c->center_y_mm;
  const bool solid = dx * dx + dy * dy <= c->radius_mm * c->radius_mm;
  return {0, solid ? grid.height_quanta : 0};
}

double columns_in_field(const StockShape& stock, double pitch_mm, RayAxis axis) {
  const BoxStock box = bounds(stock);
  const Vec3 size = to_frame(axis, box.max_mm - box.min_mm);
  const double x = columns(size.x, pitch_mm), y = columns(size.y, pitch_mm);
  // A side of more columns than their numbers can count is as good as endless.
  return std::max(x, y) < kSideColumnsMax ? x * y : std::numeric_limits<double>::infinity();
}

DexelGrid make_grid(const StockShape& stock, double pitch_mm, RayAxis axis) {
  const BoxStock box = bounds(stock);
  const Vec3 size = to_frame(axis, box.max_mm - box.min_mm);
  int exponent = 0;
  std::frexp(size.z, &exponent);  // size.z < 2^exponent
  const double quantum = std::ldexp(1.0, exponent - kDepthBits);
  return {.origin_mm = to_frame(axis, box.min_mm),
          .pitch_mm = pitch_mm,
          .z_quantum_mm = quantum,
          .columns_x = static_cast<std::int32_t>(columns(size.x, pitch_mm)),
          .columns_y = static_cast<std::int32_t>(columns(size.y, pitch_mm)),
          .height_quanta = static_cast<std::int32_t>(size.z / quantum + 0.5),
          .axis = axis};
}

}  // namespace kerf
