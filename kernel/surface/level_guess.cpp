// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/level_guess.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/dexel/stock_column.h"
#include "kernel/math/tolerance.h"
#include "kernel/surface/edge_slice.h"

namespace kerf {
namespace {

/// Rows on each side of a wall's crossing that contribute to the line fitted to the wall.
constexpr int kWallRows = 2;
/// Greatest offset of that line from the midpoint between two columns, in pitches. The wall may be
/// curved, and the midpoint itself is off by at most half a pitch.
constexpr double kOffsetMax = 0.3;
/// Pitches by which an arc may extend beyond the solid column and still be used.
constexpr double kPastMax = 0.1;
/// Weight of the plane of a wall whose direction is an estimate.
constexpr double kGuessWeight = 0.02;

}  // namespace

/// The ends next to an edge: those of the element with its solid sample, and the nearest ones below
/// and above in the empty column.
struct LevelGuess::Ends {
  SliceEnd top, bottom;
  std::optional<SliceEnd> below, above;
  bool nothing_beyond;  ///< the empty column has no element
};

/// An edge from its solid sample to its empty one.
struct LevelGuess::Edge {
  std::int32_t i, j, k;  ///< the solid sample
  std::int32_t di, dj;   ///< the step to the empty one

  bool along_x() const { return di != 0; }
  Vec3 direction() const { return {double(di), double(dj), 0}; }
  Vec3 at(double place) const { return {i + di * place, j + dj * place, double(k)}; }
  double distance(const Crossing& c) const { return (c.point.x - i) * di + (c.point.y - j) * dj; }
};

Crossing LevelGuess::find(std::int32_t i, std::int32_t j, std::int32_t k, bool along_x) const {
  Edge edge{i, j, k, along_x ? 1 : 0, along_x ? 0 : 1};
  if (!window_.solid(i, j, k)) {
    edge = {i + edge.di, j + edge.dj, k, -edge.di, -edge.dj};
  }
  const Ends ends = ends_beside(edge);
  const std::optional<Crossing> slope = on_slope(edge, ends), stock = on_stock(edge);
  if (slope && stock) {
    // The solid ends at the nearer of the two.
    return edge.distance(*slope) < edge.distance(*stock) ? *slope : *stock;
  }
  if (slope) return *slope;
  if (stock) return *stock;
  return on_wall(edge, ends);
}

SliceEnd LevelGuess::slice_end(const Edge& edge, const SolidRun& run, bool top) const {
  const Vec3& normal = top ? run.top_normal : run.bottom_normal;
  const double upright = std::max(std::abs(normal.z), kUprightMin);
  return {window_.steps(top ? run.top : run.bottom),
          -dot(normal, edge.direction()) / std::copysign(upright, normal.z), normal};
}

LevelGuess::Ends LevelGuess::ends_beside(const Edge& edge) const {
  const SolidRun* solid = window_.runs(edge.i, edge.j).data();
  while (solid->end <= edge.k) ++solid;
  Ends ends{slice_end(edge, *solid, true), slice_end(edge, *solid, false), {}, {}, false};
  const auto runs = window_.runs(edge.i + edge.di, edge.j + edge.dj);
  for (const SolidRun& run : runs) {
    if (run.end <= edge.k) ends.below = slice_end(edge, run, true);
    if (run.first > edge.k && !ends.above) ends.above = slice_end(edge, run, false);
  }
  ends.nothing_beyond = runs.empty();
  return ends;
}

/// Finds a surface that descends from the top of the solid column's element to an end of the empty
/// column, or ascends from its bottom to one.
std::optional<Crossing> LevelGuess::on_slope(const Edge& edge, const Ends& ends) const {
  std::optional<Passage> best;
  const auto consider = [&](const std::optional<Passage>& passage) {
    if (passage && (!best || passage->place < best->place)) best = passage;
  };
  if (ends.below) consider(passage(ends.top, *ends.below, edge.k));
  if (ends.above) consider(passage(ends.bottom, *ends.above, edge.k));
  if (!best || best->trust != Trust::kBoth) {
    // Where a tool's side rises steeply, the tangent planes do not determine its curvature.
    if (const auto bent = on_arc(edge, ends, best && best->trust == Trust::kHollow)) return bent;
  }
  if (!best && ends.nothing_beyond) {
    // The empty column has no element: the surface bends down (up) to its outline.
    for (const SliceEnd& end : {ends.top, ends.bottom}) {
      if (end.slope == 0) continue;
      const double place = (edge.k - end.z) / end.slope;
      if (place >= 0 && place <= 1) consider(Passage{place, end.normal, Trust::kBoth});
    }
  }
  if (!best) return std::nullopt;
  return Crossing{.point = edge.at(best->place), .normal = best->normal};
}

/// Returns the end nearest to a height `z`, in the column `steps` steps from the edge's solid one.
std::optional<SliceEnd> LevelGuess::nearest_end(const Edge& edge, int steps, double z,
                                                bool top) const {
  std::optional<SliceEnd> nearest;
  for (const SolidRun& run : window_.runs(edge.i + steps * edge.di, edge.j + steps * edge.dj)) {
    const SliceEnd end = slice_end(edge, run, top);
    if (!nearest || std::abs(end.z - z) < std::abs(nearest->z - z)) nearest = end;
  }
  return nearest;
}

/// Extrapolates the surface from the empty column's end and the ends of the two columns behind it.
/// With `arrives`, only if it reaches the end of the solid column.
std::optional<Crossing> LevelGuess::on_arc(const Edge& edge, const Ends& ends, bool arrives) const {
  std::optional<Crossing> best;
  double best_u = -1;
  for (const bool top : {true, false}) {
    const std::optional<SliceEnd>& b = top ? ends.below : ends.above;
    if (!b) continue;
    const auto c = nearest_end(edge, 2, b->z + b->slope, top);
    if (!c) continue;
    const auto d = nearest_end(edge, 3, 2 * c->z - b->z, top);
    const double up = top ? 1 : -1;
    const auto arc = SideArc::through(*b, *c, d, up, edge.direction() * -1);
    if (!arc) continue;
    const double height = (edge.k - b->z) * up, u = arc->u(height);
    // An arc that passes beyond the solid column is not the surface here.
    if (u < 0 || u > 1 + kPastMax || u <= best_u) continue;
    const double end = (top ? ends.top.z : ends.bottom.z) - b->z;
    if (arrives && std::abs(arc->u(end * up) - 1) > kPastMax) continue;
    best_u = u;
    best = Crossing{.point = edge.at(std::max(1 - u, 0.0)), .normal = arc->normal(height)};
  }
  return best;
}

/// Finds the stock's own side between a column inside the stock and one outside.
std::optional<Crossing> LevelGuess::on_stock(const Edge& edge) const {
  const DexelGrid& grid = window_.grid();
  const std::int32_t i = edge.i + edge.di, j = edge.j + edge.dj;
  const bool outside = !window_.in_grid(i, j);
  if (const auto* box = std::get_if<BoxStock>(&stock_)) {
    if (!outside) return std::nullopt;
    const Vec3 size = box->max_mm - box->min_mm;
    const double side = edge.along_x() ? size.x : size.y;
    const double wall = edge.di + edge.dj > 0 ? side / grid.pitch_mm - 0.5 : -0.5;
    const std::int32_t from = edge.along_x() ? edge.i : edge.j;
    return Crossing{.point = edge.at(std::abs(wall - from)), .normal = edge.direction()};
  }
  const auto* cylinder = std::get_if<CylinderStock>(&stock_);
  if (cylinder == nullptr) return std::nullopt;
  const CylinderStock& c = *cylinder;
  const Dexel beyond = stock_column(stock_, grid, i, j);
  if (!outside && beyond.bottom < beyond.top) return std::nullopt;
  const double x = (c.center_x_mm - grid.origin_mm.x) / grid.pitch_mm - 0.5;
  const double y = (c.center_y_mm - grid.origin_mm.y) / grid.pitch_mm - 0.5;
  const double r = c.radius_mm / grid.pitch_mm;
  const double aside = edge.along_x() ? edge.j - y : edge.i - x;
  const double from = edge.along_x() ? edge.i - x : edge.j - y;
  const double half = std::sqrt(std::max(0.0, r * r - aside * aside));
  const double place = std::clamp(half - from * (edge.di + edge.dj), 0.0, 1.0);
  const Vec3 at = edge.at(place);
  return Crossing{.point = at, .normal = normalized({at.x - x, at.y - y, 0})};
}

/// Returns the wall's offset in a neighboring row, in columns from the edge: -1, 0 or 1, read from
/// two columns on each side of the edge, or 2 if the row shows no wall there.
int LevelGuess::wall_offset(const Edge& edge, int row) const {
  int solid = 0;
  for (int n = -1; n <= 2; ++n) {
    const std::int32_t i = edge.i + (edge.along_x() ? n * edge.di : row);
    const std::int32_t j = edge.j + (edge.along_x() ? row : n * edge.dj);
    if (!window_.solid(i, j, edge.k)) continue;
    if (solid != n + 1) return 2;  // solid again behind a gap
    ++solid;
  }
  return solid == 0 || solid == 4 ? 2 : solid - 2;
}

/// Fits a line to the wall's positions in the neighboring rows that show it. Without it a wall
/// oblique to the grid would become a staircase, because columns locate it only to half a pitch.
LevelGuess::Wall LevelGuess::fit_wall(const Edge& edge) const {
  int count = 1, sum_r = 0, sum_rr = 0, sum_w = 0, sum_rw = 0;  // the edge itself: r = 0, w = 0
  for (const int direction : {-1, 1}) {
    for (int n = 1; n <= kWallRows; ++n) {
      const int row = direction * n;
      const int w = wall_offset(edge, row);
      if (w == 2) break;
      ++count;
      sum_r += row;
      sum_rr += row * row;
      sum_w += w;
      sum_rw += row * w;
    }
  }
  if (sum_w == 0 && sum_rw == 0) return {0, 0, count - 1};
  const double determinant = count * sum_rr - sum_r * sum_r;
  return {(sum_rr * sum_w - sum_r * sum_rw) / determinant,
          (count * sum_rw - sum_r * sum_w) / determinant, count - 1};
}

Crossing LevelGuess::on_wall(const Edge& edge, const Ends& ends) const {
  const Wall wall = fit_wall(edge);
  const Vec3 across = edge.along_x() ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  double place = 0.5 + std::clamp(wall.offset, -kOffsetMax, kOffsetMax);
  Crossing c{.point = {},
             .normal = wall.slope == 0 ? edge.direction()
                                       : normalized(edge.direction() - across * wall.slope),
             .wall = true};
  if (wall.rows == 0) c.weight = kGuessWeight;
  // The wall ends where it meets the tangent planes of the ends next to it: the cutting tool is
  // convex, so it removed nothing behind its tangent plane.
  const auto meet = [&](const SliceEnd& end, double from, bool nearer) {
    if (end.slope == 0) return;
    const double there = from + (edge.k - end.z) / end.slope;
    if (there <= 0 || there >= 1 || (nearer ? there >= place : there <= place)) return;
    place = there;
    c.normal = end.normal;
    c.weight = 1;
  };
  if (ends.below && ends.below->slope < 0) meet(*ends.below, 1, false);
  if (ends.above && ends.above->slope > 0) meet(*ends.above, 1, false);
  if (ends.top.slope < 0) meet(ends.top, 0, true);
  if (ends.bottom.slope > 0) meet(ends.bottom, 0, true);
  c.point = edge.at(place);
  return c;
}

}  // namespace kerf
