#include "kernel/surface/level_guess.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/dexel/stock_column.h"

namespace kerf {
namespace {

/// Cosine of the angle between two ends' normals up to which the surface between them is bent, not
/// creased.
constexpr double kSmoothCosine = 0.985;
/// Pitches. By so much two planes may miss each other and still be one surface.
constexpr double kMissMax = 0.03;
/// By this share of the rise between two ends the plane of one may miss the other.
constexpr double kBendShare = 0.25;
/// A steeper plane than this (its normal's upward part) is taken to be so steep.
constexpr double kUprightMin = 1e-4;
/// Rows on each side of a wall's crossing that take part in the line fitted to the wall.
constexpr int kWallRows = 2;
/// What the plane of a wall counts whose direction is a guess.
constexpr double kGuessWeight = 0.02;

/// An end of an element seen along an edge: its height in steps and the slope of its plane.
struct End {
  double z, slope;
  Vec3 normal;
};

/// Where a surface that runs from end `a` at 0 to end `b` at 1 passes `level`: the place and the
/// normal; nothing if no such surface does.
struct Passage {
  double place;
  Vec3 normal;
};
std::optional<Passage> passage(const End& a, const End& b, double level) {
  const double rise = b.z - a.z, turn = a.slope - b.slope;
  const double chord = rise == 0 ? 0.5 : std::clamp((level - a.z) / rise, 0.0, 1.0);
  // By so much each plane lies above the other's end.
  const double above_b = a.z + a.slope - b.z, above_a = b.z - b.slope - a.z;
  const bool smooth = dot(a.normal, b.normal) > kSmoothCosine;
  if (std::abs(above_b) <= kMissMax && std::abs(above_a) <= kMissMax) {
    return Passage{chord, normalized(a.normal * (1 - chord) + b.normal * chord)};
  }
  const double crease = turn == 0 ? -1 : above_a / turn;  // the planes meet here
  const bool meet = crease >= 0 && crease <= 1;
  // One surface is bent, and its plane misses the other end, where it meets that one's surface.
  const double miss_max = kBendShare * std::abs(rise);
  if (!meet && std::abs(above_a) > miss_max && std::abs(above_b) > miss_max) return std::nullopt;
  const double crease_z = a.z + a.slope * crease;
  const bool on_b = meet ? level >= std::min(b.z, crease_z) && level <= std::max(b.z, crease_z)
                         : std::abs(above_a) < std::abs(above_b);
  double place = on_b ? (b.slope != 0 ? 1 + (level - b.z) / b.slope : 1)
                      : (a.slope != 0 ? (level - a.z) / a.slope : 0);
  place = std::clamp(place, 0.0, 1.0);
  if (!smooth) return Passage{place, on_b ? b.normal : a.normal};
  // Of a bent surface the chord is as far on one side as the planes are on the other.
  place = 0.5 * (place + chord);
  return Passage{place, normalized(a.normal * (1 - place) + b.normal * place)};
}

}  // namespace

/// An edge from its solid sample to its empty one.
struct LevelGuess::Edge {
  std::int32_t i, j, k;  ///< the solid sample
  std::int32_t di, dj;   ///< the step to the empty one

  bool along_x() const { return di != 0; }
  Vec3 direction() const { return {double(di), double(dj), 0}; }
  Vec3 at(double place) const { return {i + di * place, j + dj * place, double(k)}; }
};

Crossing LevelGuess::find(std::int32_t i, std::int32_t j, std::int32_t k, bool along_x) const {
  Edge edge{i, j, k, along_x ? 1 : 0, along_x ? 0 : 1};
  if (!window_.solid(i, j, k)) {
    edge = {i + edge.di, j + edge.dj, k, -edge.di, -edge.dj};
  }
  const std::optional<Crossing> slope = on_slope(edge), stock = on_stock(edge);
  if (slope && stock) {
    // What the tool has left ends where the first of the two is met.
    const auto way = [&](const Crossing& c) {
      return (c.point.x - edge.i) * edge.di + (c.point.y - edge.j) * edge.dj;
    };
    return way(*slope) < way(*stock) ? *slope : *stock;
  }
  if (slope) return *slope;
  if (stock) return *stock;
  return on_wall(edge);
}

/// The surface leaves the solid column's element through its top, down to an end of the empty
/// column, or through its bottom, up to one.
std::optional<Crossing> LevelGuess::on_slope(const Edge& edge) const {
  const Vec3 e = edge.direction();
  const auto end_of = [&](std::int32_t height, Vec3 normal) {
    const double upright = std::max(std::abs(normal.z), kUprightMin);
    return End{window_.steps(height), -dot(normal, e) / std::copysign(upright, normal.z), normal};
  };
  const auto solid_runs = window_.runs(edge.i, edge.j);
  const SolidRun* solid = solid_runs.data();
  while (solid->end <= edge.k) ++solid;
  const SolidRun *below = nullptr, *above = nullptr;
  const auto empty_runs = window_.runs(edge.i + edge.di, edge.j + edge.dj);
  for (const SolidRun& run : empty_runs) {
    if (run.end <= edge.k) below = &run;
    if (run.first > edge.k && above == nullptr) above = &run;
  }
  const End top = end_of(solid->top, solid->top_normal);
  const End bottom = end_of(solid->bottom, solid->bottom_normal);
  std::optional<Passage> best;
  const auto consider = [&](const std::optional<Passage>& passage) {
    if (passage && (!best || passage->place < best->place)) best = passage;
  };
  if (below != nullptr) consider(passage(top, end_of(below->top, below->top_normal), edge.k));
  if (above != nullptr) {
    consider(passage(bottom, end_of(above->bottom, above->bottom_normal), edge.k));
  }
  if (!best && empty_runs.empty()) {
    // Nothing beyond: a surface that bends down (up) to its outline.
    for (const End& end : {top, bottom}) {
      if (end.slope == 0) continue;
      const double place = (edge.k - end.z) / end.slope;
      if (place >= 0 && place <= 1) consider(Passage{place, end.normal});
    }
  }
  if (!best) return std::nullopt;
  return Crossing{.point = edge.at(best->place), .normal = best->normal};
}

/// Between a column of the stock and the place beside it the stock's own side stands.
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

/// Where the wall stands in a neighbouring row, in columns from the edge, read from the two columns
/// on each side of it: -1, 0 or 1; 2 if the row shows no wall there.
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

/// Columns know a wall only to half a pitch: a slanted one would become a staircase. So a line is
/// fitted to where the neighbouring rows see it, as far as they do.
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

Crossing LevelGuess::on_wall(const Edge& edge) const {
  const Wall wall = fit_wall(edge);
  const Vec3 across = edge.along_x() ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  Crossing c{.point = edge.at(std::clamp(0.5 + wall.offset, 0.0, 1.0)),
             .normal = wall.slope == 0 ? edge.direction()
                                       : normalized(edge.direction() - across * wall.slope)};
  if (wall.rows == 0) c.weight = kGuessWeight;
  return c;
}

}  // namespace kerf
