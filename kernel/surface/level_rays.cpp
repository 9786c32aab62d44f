// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/level_rays.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

/// Pitches by which an end may be beyond an edge and still count as its crossing. Must exceed the
/// difference of two fields, which is the tolerance.
constexpr double kBeyondMax = 0.25;

struct RayEnd {
  std::int32_t depth;
  NormalCode code;
};

/// Returns the top (or bottom) end of a ray nearest to the depths [from, to], or nothing.
std::optional<RayEnd> nearest_end(const ColumnView& view, bool top, std::int32_t from,
                                  std::int32_t to) {
  const auto depth = [top](const Dexel& d) { return top ? d.top : d.bottom; };
  const bool any = view.topmost.bottom < view.topmost.top;
  const auto end_of = [&](std::size_t n) {
    const bool lower = n < view.lower.size();
    const EndCodes codes = !lower                     ? view.topmost_codes
                           : view.lower_codes.empty() ? EndCodes{}
                                                      : view.lower_codes[n];
    return RayEnd{depth(lower ? view.lower[n] : view.topmost), top ? codes.top : codes.bottom};
  };
  const std::size_t count = view.lower.size() + (any ? 1 : 0);
  if (count == 0) return std::nullopt;
  const auto found = std::ranges::lower_bound(view.lower, from, {}, depth);
  const auto n = static_cast<std::size_t>(found - view.lower.begin());
  // The first end at or above `from`, and the one before it.
  const bool has_next = n < count && end_of(n).depth >= from;
  const bool has_before = has_next ? n > 0 : true;
  if (has_next && end_of(n).depth <= to) return end_of(n);
  if (!has_before) return end_of(n);
  const RayEnd before = end_of(has_next ? n - 1 : count - 1);
  if (!has_next) return before;
  return end_of(n).depth - to < from - before.depth ? end_of(n) : before;
}

}  // namespace

LevelRays::LevelRays(const SolidSnapshot& solid)
    : x_field_(solid.fields[1]), y_field_(solid.fields[2]) {}

std::optional<Crossing> LevelRays::find(std::int32_t i, std::int32_t j, std::int32_t k,
                                        bool along_x, bool leaves) const {
  const DexelSnapshot& field = along_x ? x_field_ : y_field_;
  const DexelGrid& grid = field.grid();
  // Frames of the fields (RayAxis): (y, z, x) along X, (z, x, y) along Y.
  const std::int32_t ray_i = along_x ? j : k, ray_j = along_x ? k : i, first = along_x ? i : j;
  const double quanta_per_pitch = grid.pitch_mm / grid.z_quantum_mm;
  const auto depth_of = [&](double place) {
    return static_cast<std::int32_t>(
        std::clamp((place + 0.5) * quanta_per_pitch, -1.0, double(grid.height_quanta) + 1));
  };
  const ColumnView view = field.view(ray_i, ray_j);
  const auto end = nearest_end(view, leaves, depth_of(first), depth_of(first + 1));
  if (!end) return std::nullopt;
  const double place = end->depth / quanta_per_pitch - 0.5;
  if (place < first - kBeyondMax || place > first + 1 + kBeyondMax) return std::nullopt;
  Crossing c;
  c.point = along_x ? Vec3{place, double(j), double(k)} : Vec3{double(i), place, double(k)};
  c.normal = from_frame(grid.axis, field.normal(ray_i, ray_j, end->depth, leaves, end->code));
  c.original = field.is_original(ray_i, ray_j, end->depth, leaves, end->code);
  return c;
}

}  // namespace kerf
