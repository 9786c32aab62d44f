// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/bare_loop.h"

#include <algorithm>
#include <cmath>

#include "tests/bench/bare_surfaces.h"

namespace kerf::test {
namespace {

constexpr double kStockTop = 50, kStockSide = 100;

template <class Surface>
KERF_INLINE BareLoop::Sums cut_row(const Surface& surface, const BareLoop::Row& row) {
  float volume = 0, x = 0, z = 0;
  for (int i = 0; i < row.count; ++i) {
    const float px = row.x + float(i) * row.pitch;
    const float top = row.tops[i], lowest = surface.at(px, row.y);
    const float left = lowest < top ? lowest : top, removed = top - left;
    volume += removed;
    x += removed * px;
    z += removed * (top + left);
    row.tops[i] = left;
  }
  return {volume, x, z};
}

// A function for each surface, because templates cannot be cloned for several targets.
#define KERF_CUT_ROW_OF(Surface)                                                       \
  KERF_VECTOR_CLONES                                                                   \
  void cut_one_row(const Surface& s, const BareLoop::Row& row, BareLoop::Sums& sums) { \
    sums = cut_row(s, row);                                                            \
  }
KERF_CUT_ROW_OF(UprightSweep<BareTool::kBall>)
KERF_CUT_ROW_OF(UprightSweep<BareTool::kFlat>)
KERF_CUT_ROW_OF(UprightSweep<BareTool::kBullNose>)
KERF_CUT_ROW_OF(TurningMove<BareTool::kBall>)
KERF_CUT_ROW_OF(TurningMove<BareTool::kFlat>)
KERF_CUT_ROW_OF(TurningMove<BareTool::kBullNose>)
#undef KERF_CUT_ROW_OF

/// Calls `cut` with the tool that moves between two poses.
template <template <BareTool> class Surface, class Cut>
void visit(BareTool tool, const ToolPose& from, const ToolPose& to, const Cut& cut) {
  switch (tool) {
    case BareTool::kBall:
      return cut(Surface<BareTool::kBall>(from, to));
    case BareTool::kFlat:
      return cut(Surface<BareTool::kFlat>(from, to));
    case BareTool::kBullNose:
      return cut(Surface<BareTool::kBullNose>(from, to));
  }
}

}  // namespace

BareLoop::BareLoop(BareTool tool, double pitch_mm)
    : tool_(tool),
      columns_(int(std::lround(kStockSide / pitch_mm))),
      pitch_(float(pitch_mm)),
      top_(std::size_t(columns_) * std::size_t(columns_), float(kStockTop)) {}

void BareLoop::move(const ToolPose& from, const ToolPose& to) {
  // The tool up to the stock's top. Its axis may lean.
  Vec3 min{1e300, 1e300, 0}, max{-1e300, -1e300, 0};
  for (const ToolPose& p : {from, to}) {
    const double high = std::max(0.0, kStockTop + 5 - p.tip_mm.z) / p.axis.z;
    for (const Vec3& at : {p.tip_mm, p.tip_mm + p.axis * (p.axis.z < 1 ? high : 0)}) {
      min = {std::min(min.x, at.x - 5), std::min(min.y, at.y - 5), 0};
      max = {std::max(max.x, at.x + 5), std::max(max.y, at.y + 5), 0};
    }
  }
  const auto cut_with = [&](const auto& surface) { cut(surface, min, max); };
  if (from.axis.z == 1 && to.axis.z == 1) {
    visit<UprightSweep>(tool_, from, to, cut_with);
  } else {
    visit<TurningMove>(tool_, from, to, cut_with);
  }
}

template <class Surface>
void BareLoop::cut(const Surface& surface, Vec3 min, Vec3 max) {
  const auto index = [&](double x) { return std::clamp(int(x / double(pitch_)), 0, columns_ - 1); };
  const int i0 = index(min.x), count = index(max.x) - i0 + 1;
  for (int j = index(min.y); j <= index(max.y); ++j) {
    const std::size_t at = std::size_t(j) * std::size_t(columns_) + std::size_t(i0);
    const float y = (float(j) + 0.5F) * pitch_;
    Sums sums;
    cut_one_row(surface, {&top_[at], count, pitch_, (float(i0) + 0.5F) * pitch_, y}, sums);
    volume_ += double(sums.volume);
    moment_x_ += double(sums.x);
    moment_y_ += double(sums.volume * y);
    moment_z_ += double(sums.z);
  }
}

double BareLoop::removed_mm3() const { return volume_ * double(pitch_) * double(pitch_); }

}  // namespace kerf::test
