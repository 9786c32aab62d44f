// SPDX-License-Identifier: Apache-2.0
#include "server/history/motion_spans.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kerf {
namespace {

/// Most strokes with an open span. With more hands, each closes another's.
constexpr std::size_t kOpenMax = 64;

std::array<double, 3> coordinates(Vec3 v) { return {v.x, v.y, v.z}; }

float rounded_down(double value) {
  return std::nextafter(static_cast<float>(value), -std::numeric_limits<float>::infinity());
}
float rounded_up(double value) {
  return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
}

}  // namespace

/// Adds a motion to a span. Returns false if that would become too long.
bool MotionSpans::extend(Open& open, std::uint64_t record, const Bounds& box) {
  MotionSpan longer = spans_[open.span];
  const auto lo = coordinates(box.lo_mm), hi = coordinates(box.hi_mm);
  for (std::size_t n = 0; n < 3; ++n) {
    longer.lo_mm[n] = std::min(longer.lo_mm[n], rounded_down(lo[n]));
    longer.hi_mm[n] = std::max(longer.hi_mm[n], rounded_up(hi[n]));
    if (double(longer.hi_mm[n]) - double(longer.lo_mm[n]) > open.most_mm[n]) return false;
  }
  longer.run.last = record;
  spans_[open.span] = longer;
  ++open.motions;
  return true;
}

void MotionSpans::add(std::uint64_t record, StrokeId stroke, const Bounds& box) {
  const auto open = std::ranges::find(open_, stroke, &Open::stroke);
  if (open != open_.end()) {
    const bool near = record - spans_[open->span].run.last <= kGap;
    if (near && open->motions < kMotionsMax && extend(*open, record, box)) {
      std::rotate(open, open + 1, open_.end());
      return;
    }
    open_.erase(open);
  } else if (open_.size() == kOpenMax) {
    open_.erase(open_.begin());
  }
  MotionSpan span{{stroke, record, record}, {}, {}};
  Open next{stroke, spans_.size(), 1, {}};
  const auto lo = coordinates(box.lo_mm), hi = coordinates(box.hi_mm);
  for (std::size_t n = 0; n < 3; ++n) {
    span.lo_mm[n] = rounded_down(lo[n]);
    span.hi_mm[n] = rounded_up(hi[n]);
    next.most_mm[n] = hi[n] - lo[n] + growth_mm_;
  }
  spans_.push_back(span);
  open_.push_back(next);
}

Bounds tile_bounds(const DexelGrid& grid, TileIndex tile) {
  const double side_mm = kTileSide * grid.pitch_mm;
  const Vec3 lo = grid.origin_mm + Vec3{tile.x * side_mm, tile.y * side_mm, 0};
  const Vec3 hi{lo.x + side_mm, lo.y + side_mm, grid.z_mm(grid.height_quanta)};
  return {from_frame(grid.axis, lo), from_frame(grid.axis, hi)};
}

}  // namespace kerf
