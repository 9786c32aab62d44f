// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/stock_faces.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Returns the length of the stretch that the column does not fill.
double empty_mm(const DexelGrid& grid, std::span<const Dexel> column, double lo, double hi) {
  double empty = hi - lo;
  for (const Dexel& d : column)
    empty -= std::max(0.0, std::min(hi, grid.z_mm(d.top)) - std::max(lo, grid.z_mm(d.bottom)));
  return std::max(0.0, empty);
}

}  // namespace

void StockFaces::add(const DexelField& field, std::int32_t i, std::int32_t j, Steps steps,
                     double lo_mm, double hi_mm) {
  const DexelGrid& grid = field.grid();
  const double p = grid.pitch_mm;
  const double least_full = hi_mm - lo_mm - kDepthEpsilonMm;
  const auto keep = [&](Vec3 area) {
    if (area != Vec3{}) areas_mm2_.push_back(from_frame(grid.axis, area));
  };
  const auto empty_at = [&](std::int32_t at_i, std::int32_t at_j) {
    return empty_mm(grid, field.column(at_i, at_j, beside_), lo_mm, hi_mm);
  };
  // The next sample shows the slope of the end if it lacks a part of the stretch, and a wall if it
  // lacks all of it. A slope that leaves a short stretch before the next sample is not a wall; the
  // adjacent column shows it.
  Vec3 end;
  const auto look = [&](std::int32_t di, std::int32_t dj) {
    const std::int32_t step = di != 0 ? steps.i : steps.j;
    const Vec3 across = Vec3{di * steps.j * p, dj * steps.i * p, 0};
    const double empty = empty_at(i + di * step, j + dj * step);
    if (empty < least_full) {
      end = end + across * empty;
      return;
    }
    const double near = step > 1 ? empty_at(i + di, j + dj) : empty;
    if (near < least_full && near * step >= least_full) {
      end = end + across * (near * step);
    } else {
      keep(across * empty);
    }
  };
  look(1, 0), look(-1, 0), look(0, 1), look(0, -1);
  const double area_mm2 = steps.i * p * (steps.j * p);
  for (const Dexel& d : field.column(i, j, beside_)) {
    if (std::abs(grid.z_mm(d.top) - hi_mm) < kDepthEpsilonMm) end.z += area_mm2;
    if (std::abs(grid.z_mm(d.bottom) - lo_mm) < kDepthEpsilonMm) end.z -= area_mm2;
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
