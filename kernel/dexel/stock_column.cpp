// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/stock_column.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/dexel/column_shares.h"
#include "kernel/dexel/dexel_tile.h"

namespace kerf {
namespace {

constexpr int kDepthBits = 30;
constexpr double kSideColumnsMax = 0x7fffff00;

/// Returns the chord of a ray across an upright cylinder, at the distance `aside_mm` from the axis.
/// `center_mm` is the axis' coordinate along the ray.
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

std::int32_t length(Dexel d) { return d.top - d.bottom; }

/// Counts the columns of row j of the field along Z whose centers are in the cylinder. They are
/// contiguous and near the cylinder's axis, so bisection finds the first and the last.
std::int64_t row_of_cylinder(const CylinderStock& c, const DexelGrid& grid, std::int32_t j) {
  const auto solid = [&](std::int32_t i) { return length(stock_column(c, grid, i, j)) > 0; };
  const double middle = (c.center_x_mm - grid.origin_mm.x) / grid.pitch_mm;
  const auto near = static_cast<std::int32_t>(std::clamp(middle, 0.0, grid.columns_x - 1.0));
  std::int32_t inside = -1;
  for (const std::int32_t i : {near - 1, near, near + 1}) {
    if (i >= 0 && i < grid.columns_x && solid(i)) inside = i;
  }
  if (inside < 0) return 0;
  std::int32_t first = inside, last = inside;
  for (std::int32_t out = -1; first - out > 1;) {
    const std::int32_t i = out + (first - out) / 2;
    (solid(i) ? first : out) = i;
  }
  for (std::int32_t out = grid.columns_x; out - last > 1;) {
    const std::int32_t i = last + (out - last) / 2;
    (solid(i) ? last : out) = i;
  }
  return last - first + 1;
}

double columns(double size_mm, double pitch_mm) {
  return std::max(1.0, std::floor(size_mm / pitch_mm + 0.5));
}

}  // namespace

BoxStock stock_bounds(const StockShape& stock) {
  if (const auto* box = std::get_if<BoxStock>(&stock)) return *box;
  const auto& c = std::get<CylinderStock>(stock);
  return {{c.center_x_mm - c.radius_mm, c.center_y_mm - c.radius_mm, c.min_z_mm},
          {c.center_x_mm + c.radius_mm, c.center_y_mm + c.radius_mm, c.max_z_mm}};
}

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

Vec3 stock_normal(const StockShape& stock, const DexelGrid& grid, std::int32_t i, std::int32_t j,
                  std::int32_t depth, bool is_top) {
  const auto* c = std::get_if<CylinderStock>(&stock);
  if (c == nullptr || grid.axis == RayAxis::kZ) return {0, 0, is_top ? 1.0 : -1.0};
  // In its own frame the field along X has the cylinder's axis along y, the field along Y along x.
  const Vec3 at{grid.x_mm(i), grid.y_mm(j), grid.z_mm(depth)};
  const Vec3 from_axis = grid.axis == RayAxis::kX
                             ? Vec3{at.x - c->center_y_mm, 0, at.z - c->center_x_mm}
                             : Vec3{0, at.y - c->center_x_mm, at.z - c->center_y_mm};
  return normalized(from_axis);
}

void fill_from_stock(const StockShape& stock, const DexelGrid& grid, TileIndex at,
                     DexelTile& tile) {
  tile.bottom.fill(0);
  tile.top.fill(0);
  for (int row = 0; row < kTileSide; ++row) {
    const std::int32_t j = at.y * kTileSide + row;
    for (int c = 0; c < kTileSide; ++c) {
      const std::int32_t i = at.x * kTileSide + c;
      if (i >= grid.columns_x || j >= grid.columns_y) continue;
      const Dexel whole = stock_column(stock, grid, i, j);
      if (whole.bottom >= whole.top) continue;
      tile.bottom[std::size_t(row * kTileSide + c)] = whole.bottom;
      tile.top[std::size_t(row * kTileSide + c)] = whole.top;
    }
  }
  tile.update_bounds();
}

double stock_quanta(const StockShape& stock, const DexelGrid& grid) {
  const ColumnShares shares(stock, grid);
  const std::int32_t last_i = grid.columns_x - 1, last_j = grid.columns_y - 1;
  const double across = last_i + shares.of_column(last_i), along = last_j + shares.of_row(last_j);
  const auto* c = std::get_if<CylinderStock>(&stock);
  if (c == nullptr) return across * along * double(grid.height_quanta);
  // Adds all columns as whole ones, which is exact, and then the surplus of the last ones.
  const auto more = [&](std::int32_t i, std::int32_t j, double share) {
    return length(stock_column(*c, grid, i, j)) * (share - 1);
  };
  std::int64_t sum = 0;
  switch (grid.axis) {
    case RayAxis::kX:  // All rows are equal.
      for (std::int32_t i = 0; i < grid.columns_x; ++i) sum += length(stock_column(*c, grid, i, 0));
      return (double(sum) + more(last_i, 0, shares.of_column(last_i))) * along;
    case RayAxis::kY:  // All columns of a row are equal.
      for (std::int32_t j = 0; j < grid.columns_y; ++j) sum += length(stock_column(*c, grid, 0, j));
      return (double(sum) + more(0, last_j, shares.of_row(last_j))) * across;
    case RayAxis::kZ:
      break;
  }
  double at_border = 0;
  for (std::int32_t j = 0; j < grid.columns_y; ++j) {
    const std::int64_t row = row_of_cylinder(*c, grid, j);
    sum += row;
    const double last = more(last_i, j, shares.of_column(last_i)) / grid.height_quanta;
    at_border += (double(row) + last) * shares.of_row(j) - double(row);
  }
  return (double(sum) + at_border) * grid.height_quanta;
}

double columns_in_field(const StockShape& stock, double pitch_mm, RayAxis axis) {
  const BoxStock box = stock_bounds(stock);
  const Vec3 size = to_frame(axis, box.max_mm - box.min_mm);
  const double x = columns(size.x, pitch_mm), y = columns(size.y, pitch_mm);
  // A side with more columns than an index can count is treated as infinite.
  return std::max(x, y) < kSideColumnsMax ? x * y : std::numeric_limits<double>::infinity();
}

DexelGrid make_grid(const StockShape& stock, double pitch_mm, RayAxis axis) {
  const BoxStock box = stock_bounds(stock);
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
