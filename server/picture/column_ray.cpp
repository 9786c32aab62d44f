// SPDX-License-Identifier: Apache-2.0
#include "server/picture/column_ray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kerf {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
/// A side of columns belongs to a slope, not a wall, if it is no higher than the slope of its top
/// explains, with this margin.
constexpr double kSlopeSpare = 1.5;
constexpr double kSlopeSparePitches = 0.25;
/// Half the side of the square of columns whose gaps determine the direction of a wall.
constexpr int kWallReach = 2;

enum class Face : std::uint8_t { kX, kY, kZ };

/// A ray in the field. Depths are in quanta, columns are numbered as in DexelGrid.
struct Walk {
  double t = 0, t_end = 0;  ///< mm along the ray: where it enters the column; leaves the grid
  double next_x = kFar, next_y = kFar, per_x = kFar, per_y = kFar;  ///< mm to the next columns
  std::int32_t i = 0, j = 0, step_x = 1, step_y = 1;
  Face face = Face::kZ;          ///< through which it enters the column
  double depth = 0, per_mm = 0;  ///< at t = 0, and its change per mm

  double depth_at(double at) const { return depth + at * per_mm; }
  double t_out() const { return std::min({next_x, next_y, t_end}); }
  void advance() {
    const bool along_x = next_x < next_y;
    face = along_x ? Face::kX : Face::kY;
    t = along_x ? next_x : next_y;
    (along_x ? i : j) += along_x ? step_x : step_y;
    (along_x ? next_x : next_y) += along_x ? per_x : per_y;
  }
};

/// Narrows [enter, leave] to the part of the ray inside the slab [low, high].
struct Slabs {
  double enter = 0, leave = kFar;
  Face face = Face::kZ;
  void clip(double from, double towards, double low, double high, Face side) {
    if (towards == 0) {
      if (from < low || from > high) leave = -kFar;
      return;
    }
    const double a = (low - from) / towards, b = (high - from) / towards;
    if (std::min(a, b) > enter) {
      enter = std::min(a, b);
      face = side;
    }
    leave = std::min(leave, std::max(a, b));
  }
};

/// The first border of columns after `t`, and the distance between borders.
void set_borders(double from, double towards, double pitch, std::int32_t column, double& next,
                 double& per, std::int32_t& step) {
  if (towards == 0) return;
  step = towards > 0 ? 1 : -1;
  per = pitch / std::abs(towards);
  next = ((column + (towards > 0 ? 1 : 0)) * pitch - from) / towards;
}

std::optional<Walk> start(const DexelGrid& grid, Vec3 from_mm, Vec3 towards) {
  const Vec3 from = from_mm - grid.origin_mm;
  const double width = grid.columns_x * grid.pitch_mm, length = grid.columns_y * grid.pitch_mm;
  Slabs slabs;
  slabs.clip(from.x, towards.x, 0, width, Face::kX);
  slabs.clip(from.y, towards.y, 0, length, Face::kY);
  slabs.clip(from.z, towards.z, 0, grid.height_quanta * grid.z_quantum_mm, Face::kZ);
  if (!(slabs.enter < slabs.leave)) return std::nullopt;
  Walk walk;
  walk.t = slabs.enter;
  walk.t_end = slabs.leave;
  walk.face = slabs.face;
  const auto column = [&](double at, std::int32_t columns) {
    return std::clamp(static_cast<std::int32_t>(std::floor(at / grid.pitch_mm)), 0, columns - 1);
  };
  walk.i = column(from.x + walk.t * towards.x, grid.columns_x);
  walk.j = column(from.y + walk.t * towards.y, grid.columns_y);
  set_borders(from.x, towards.x, grid.pitch_mm, walk.i, walk.next_x, walk.per_x, walk.step_x);
  set_borders(from.y, towards.y, grid.pitch_mm, walk.j, walk.next_y, walk.per_y, walk.step_y);
  walk.depth = from.z / grid.z_quantum_mm;
  walk.per_mm = towards.z / grid.z_quantum_mm;
  return walk;
}

/// An element of a column that a ray meets.
struct Meeting {
  double t = kFar;
  Face face = Face::kZ;  ///< kZ: at its top or bottom
  bool at_top = false;
  Dexel element;
  EndCodes codes;
};

void meet(const Walk& walk, const Dexel& element, const EndCodes& codes, Meeting& nearest) {
  const double in = walk.depth_at(walk.t), out = walk.depth_at(walk.t_out());
  const bool falls = walk.per_mm < 0;
  Meeting one{kFar, Face::kZ, falls, element, codes};
  // One quantum of tolerance: the ray may enter the grid at the very top of the stock.
  if (walk.face == Face::kZ && std::abs(in - (falls ? element.top : element.bottom)) <= 1) {
    one.t = walk.t;
  } else if (in >= element.bottom && in <= element.top) {
    one.t = walk.t;
    one.face = walk.face;
  } else if (falls && in > element.top && out <= element.top) {
    one.t = (element.top - walk.depth) / walk.per_mm;
  } else if (!falls && in < element.bottom && out >= element.bottom) {
    one.t = (element.bottom - walk.depth) / walk.per_mm;
  }
  if (one.t < nearest.t) nearest = one;
}

Meeting meeting_in_column(const DexelSnapshot& field, const Walk& walk) {
  Meeting nearest;
  const ColumnView column = field.view(walk.i, walk.j);
  if (column.topmost.bottom == column.topmost.top) return nearest;
  meet(walk, column.topmost, column.topmost_codes, nearest);
  for (std::size_t n = 0; n < column.lower.size(); ++n) {
    const EndCodes codes = column.lower_codes.empty() ? EndCodes{} : column.lower_codes[n];
    meet(walk, column.lower[n], codes, nearest);
  }
  return nearest;
}

/// Upper bound of the depths of the 8 x 8 columns around column (i, j).
std::int32_t block_top(const DexelSnapshot& field, std::int32_t i, std::int32_t j) {
  const DexelTile* tile = field.tiles().find({i / kTileSide, j / kTileSide});
  if (tile == nullptr) return field.grid().height_quanta;
  return tile->block_top[std::size_t(j % kTileSide / 8 * kTileBlocksAcross + i % kTileSide / 8)];
}

/// Walks to the first element that the ray meets, or to the end of the grid (t is infinite).
Meeting find_meeting(const DexelSnapshot& field, Walk& walk) {
  const DexelGrid& grid = field.grid();
  std::int32_t block_i = -1, block_j = -1, top = 0;
  while (walk.i >= 0 && walk.j >= 0 && walk.i < grid.columns_x && walk.j < grid.columns_y &&
         walk.t < walk.t_end) {
    if (walk.i / 8 != block_i || walk.j / 8 != block_j) {
      block_i = walk.i / 8;
      block_j = walk.j / 8;
      top = block_top(field, walk.i, walk.j);
    }
    if (std::min(walk.depth_at(walk.t), walk.depth_at(walk.t_out())) <= top + 1) {
      const Meeting meeting = meeting_in_column(field, walk);
      if (meeting.t < kFar) return meeting;
    }
    walk.advance();
  }
  return {};
}

bool is_solid(const DexelSnapshot& field, std::int32_t i, std::int32_t j, double depth) {
  const ColumnView column = field.view(i, j);
  const auto holds = [depth](const Dexel& e) { return depth >= e.bottom && depth < e.top; };
  return holds(column.topmost) || std::ranges::any_of(column.lower, holds);
}

/// The normal of a wall at column (i, j): away from the solid around it, against the ray.
Vec3 wall_normal(const DexelSnapshot& field, const Walk& walk, Vec3 towards, double depth,
                 Vec3 side) {
  Vec3 sum;
  for (int dj = -kWallReach; dj <= kWallReach; ++dj) {
    for (int di = -kWallReach; di <= kWallReach; ++di) {
      if (is_solid(field, walk.i + di, walk.j + dj, depth)) sum = sum - Vec3{1.0 * di, 1.0 * dj, 0};
    }
  }
  return dot(sum, side) > 0 && dot(sum, towards) < 0 ? normalized(sum) : side;
}

/// The column from which the ray came.
std::array<std::int32_t, 2> previous(const Walk& walk) {
  if (walk.face == Face::kX) return {walk.i - walk.step_x, walk.j};
  return {walk.i, walk.j - walk.step_y};
}

/// Height of an element's top above the stock of the previous column, mm, or infinite if that is
/// empty.
double step_mm(const DexelSnapshot& field, std::int32_t i, std::int32_t j, std::int32_t top) {
  const ColumnView column = field.view(i, j);
  double below = -kFar;
  const auto take = [&](const Dexel& e) {
    if (e.bottom < e.top && e.top <= top) below = std::max(below, 1.0 * e.top);
  };
  take(column.topmost);
  for (const Dexel& element : column.lower) take(element);
  return (top - below) * field.grid().z_quantum_mm;
}

bool was_empty(const DexelSnapshot& field, std::int32_t i, std::int32_t j, double depth) {
  const ColumnView column = field.untouched_view(i, j);
  const auto holds = [depth](const Dexel& e) { return depth >= e.bottom && depth < e.top; };
  return !holds(column.topmost) && std::ranges::none_of(column.lower, holds);
}

/// Normal and kind of the surface where the ray enters a column through its side: that of the slope
/// of the column's top, or else of a wall.
void describe_side(const DexelSnapshot& field, const Walk& walk, Vec3 towards, const Meeting& met,
                   RayHit& hit) {
  const auto [i, j] = previous(walk);
  const double pitch = field.grid().pitch_mm;
  const Vec3 top = field.normal(walk.i, walk.j, met.element.top, true, met.codes.top);
  const double run = std::sqrt(top.x * top.x + top.y * top.y);
  if (met.codes.top != kStockNormal && top.z > 0 && dot(top, towards) < 0 &&
      step_mm(field, i, j, met.element.top) * top.z <=
          pitch * (kSlopeSpare * run + kSlopeSparePitches * top.z)) {
    hit.normal = top;
    hit.is_cut = !field.is_original(walk.i, walk.j, met.element.top, true, met.codes.top);
    return;
  }
  const Vec3 side =
      met.face == Face::kX ? Vec3{-1.0 * walk.step_x, 0, 0} : Vec3{0, -1.0 * walk.step_y, 0};
  const bool at_border =
      i < 0 || j < 0 || i >= field.grid().columns_x || j >= field.grid().columns_y;
  const double depth = walk.depth_at(met.t);
  hit.normal = at_border ? side : wall_normal(field, walk, towards, depth, side);
  hit.is_cut = !was_empty(field, i, j, depth);
}

}  // namespace

std::optional<RayHit> first_hit(const DexelSnapshot& field, Vec3 from_mm, Vec3 towards) {
  auto walk = start(field.grid(), from_mm, towards);
  if (!walk) return std::nullopt;
  const Meeting met = find_meeting(field, *walk);
  if (met.t == kFar) return std::nullopt;
  RayHit hit{.point_mm = from_mm + towards * met.t, .normal = {}};
  if (met.face == Face::kZ) {
    const std::int32_t depth = met.at_top ? met.element.top : met.element.bottom;
    const NormalCode code = met.at_top ? met.codes.top : met.codes.bottom;
    hit.normal = field.normal(walk->i, walk->j, depth, met.at_top, code);
    hit.is_cut = !field.is_original(walk->i, walk->j, depth, met.at_top, code);
  } else {
    describe_side(field, *walk, towards, met, hit);
  }
  return hit;
}

bool meets_stock(const DexelSnapshot& field, Vec3 from_mm, Vec3 towards) {
  auto walk = start(field.grid(), from_mm, towards);
  return walk && find_meeting(field, *walk).t < kFar;
}

}  // namespace kerf
