// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/stock_faces.h"

#include <algorithm>
#include <cmath>

#include "kernel/dexel/stock_column.h"
#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

void read_column(const DexelField& field, std::int32_t i, std::int32_t j, std::vector<Dexel>& out) {
  const DexelGrid& grid = field.grid();
  out.clear();
  if (i < 0 || j < 0 || i >= grid.columns_x || j >= grid.columns_y) return;
  const DexelTile* tile = field.find({i / kTileSide, j / kTileSide});
  if (tile == nullptr) {
    out.assign(1, stock_column(field.stock(), grid, i, j));
  } else {
    tile->read((j % kTileSide) * kTileSide + i % kTileSide, out);
  }
}

/// Length of a stretch that a column does not fill.
double empty_mm(const DexelGrid& grid, const std::vector<Dexel>& column, double lo, double hi) {
  double empty = hi - lo;
  for (const Dexel& d : column)
    empty -= std::max(0.0, std::min(hi, grid.z_mm(d.top)) - std::max(lo, grid.z_mm(d.bottom)));
  return std::max(0.0, empty);
}

}  // namespace

void StockFaces::add(const DexelField& field, std::int32_t i, std::int32_t j, double lo_mm,
                     double hi_mm, double weight) {
  const DexelGrid& grid = field.grid();
  const double p = grid.pitch_mm;
  const auto keep = [&](Vec3 area) {
    if (area != Vec3{}) areas_mm2_.push_back(from_frame(grid.axis, area) * weight);
  };
  // A neighbor that lacks a part shows how the end of the column slopes, one that lacks all a wall.
  Vec3 end;
  const auto look = [&](std::int32_t di, std::int32_t dj) {
    read_column(field, i + di, j + dj, beside_);
    const double empty = empty_mm(grid, beside_, lo_mm, hi_mm);
    const Vec3 area = Vec3{double(di), double(dj), 0} * (empty * p);
    if (empty < hi_mm - lo_mm - kDepthEpsilonMm) {
      end = end + area;
    } else {
      keep(area);
    }
  };
  look(1, 0), look(-1, 0), look(0, 1), look(0, -1);
  read_column(field, i, j, beside_);
  for (const Dexel& d : beside_) {
    if (std::abs(grid.z_mm(d.top) - hi_mm) < kDepthEpsilonMm) end.z += p * p;
    if (std::abs(grid.z_mm(d.bottom) - lo_mm) < kDepthEpsilonMm) end.z -= p * p;
  }
  keep(end);
}

Vec3 StockFaces::towards(Vec3 direction) const {
  Vec3 sum;
  for (const Vec3& area : areas_mm2_) {
    const double cosine = dot(area, direction) / length(area);
    if (cosine > 0) sum = sum + area * (cosine * cosine);
  }
  return sum == Vec3{} ? sum : normalized(sum);
}

}  // namespace kerf
