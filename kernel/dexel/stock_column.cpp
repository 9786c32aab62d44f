#include "kernel/dexel/stock_column.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

constexpr int kDepthBits = 30;

BoxStock bounds(const StockShape& stock) {
  if (const auto* box = std::get_if<BoxStock>(&stock)) return *box;
  const auto& c = std::get<CylinderStock>(stock);
  return {{c.center_x_mm - c.radius_mm, c.center_y_mm - c.radius_mm, c.min_z_mm},
          {c.center_x_mm + c.radius_mm, c.center_y_mm + c.radius_mm, c.max_z_mm}};
}

std::int32_t columns(double size_mm, double pitch_mm) {
  return std::max(1, static_cast<std::int32_t>(std::floor(size_mm / pitch_mm + 0.5)));
}

}  // namespace

DexelGrid make_grid(const StockShape& stock, double pitch_mm) {
  const BoxStock box = bounds(stock);
  const Vec3 size = box.max_mm - box.min_mm;
  int exponent = 0;
  std::frexp(size.z, &exponent);  // size.z < 2^exponent
  const double quantum = std::ldexp(1.0, exponent - kDepthBits);
  return {.origin_mm = box.min_mm,
          .pitch_mm = pitch_mm,
          .z_quantum_mm = quantum,
          .columns_x = columns(size.x, pitch_mm),
          .columns_y = columns(size.y, pitch_mm),
          .height_quanta = static_cast<std::int32_t>(size.z / quantum + 0.5)};
}

}  // namespace kerf
