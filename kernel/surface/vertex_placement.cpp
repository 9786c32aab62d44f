// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/vertex_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/dexel/stock_column.h"

namespace kerf {
namespace {

/// Least distance of a vertex from its cell's sides, in pitches, so that no two vertices coincide.
/// It does not apply to the upper side, so that a floor at a sample's height is exact.
constexpr double kMarginMin = 1.0 / 1024;
/// The same distance as a share of the block's size, for blocks where floats are coarser.
constexpr double kMarginOfSize = 1.0 / (1 << 21);
/// The same distance at the bottom of a cell as a share of the block's height, for blocks thinner
/// than that margin.
constexpr double kMarginOfHeight = 0.25;
/// Share of the pitch by which coinciding vertices of two sheets are separated.
constexpr double kSheetShift = 1.0 / 64;

/// Share of the least distance by which the center of a fan is raised off the plane of a floor.
constexpr double kShareRaised = 0.25;

/// Distances of a vertex from a plane of its crossings, and from all crossings, in pitches, beyond
/// which it is moved towards a crossing.
constexpr double kPlaneOffMax = 0.2, kVertexOffMax = 0.45;

/// Number of cached horizontal edges, a power of two, enough for two rows of cells.
constexpr std::size_t kEdgesSeen = 1024;

/// Restricts the limits of a sheet with a wall that no ray meets. Such a wall is only known to be
/// between two columns, and its direction less well, so the intersection of estimated planes is
/// unreliable. The vertex stays between its crossings; where walls of both directions meet, midway,
/// because whether they form a corner is unknown.
CellLimits within_walls(std::span<const Crossing> crossings, std::span<const std::uint8_t> edges,
                        CellLimits limits) {
  const bool any = std::ranges::any_of(crossings, [](const Crossing& c) { return c.wall; });
  if (!any) return limits;
  Vec3 low = crossings.front().point, high = low, sum;
  std::array<int, 3> along{};  // crossings of edges along x, y and z
  for (std::size_t n = 0; n < crossings.size(); ++n) {
    const Vec3& p = crossings[n].point;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), 0};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), 0};
    ++along[edges[n] / 4U];
    if (edges[n] < 8) sum = sum + p;
  }
  if (along[0] > 0 && along[1] > 0) low = high = sum * (1.0 / (along[0] + along[1]));
  const auto narrow = [](double& least, double& most, double from, double to) {
    const double l = least, m = most;
    least = std::clamp(from, l, m);
    most = std::clamp(to, l, m);
  };
  narrow(limits.low.x, limits.high.x, low.x, high.x);
  narrow(limits.low.y, limits.high.y, low.y, high.y);
  return limits;
}

bool is_across_axis(Vec3 normal) {
  return (normal.x != 0) + (normal.y != 0) + (normal.z != 0) == 1;
}

/// Returns the vertex of a crease. If it is far from all crossings and from one of their planes,
/// returns a point on the line from the nearest crossing to it, within half a pitch of the
/// crossing: these planes belong to several creases, and a crossing is on the surface. A vertex on
/// a plane across an axis stays, because its face may be merged with other faces.
Vec3 near_surface(std::span<const Crossing> crossings, Vec3 place) {
  double least2 = std::numeric_limits<double>::infinity(), off = 0;
  Vec3 nearest;
  for (const Crossing& c : crossings) {
    if (c.wall || c.is_guess() || is_across_axis(c.normal)) return place;
    const Vec3 from = place - c.point;
    off = std::max(off, std::abs(dot(c.normal, from)));
    if (dot(from, from) >= least2) continue;
    least2 = dot(from, from);
    nearest = c.point;
  }
  if (off <= kPlaneOffMax || least2 <= kVertexOffMax * kVertexOffMax) return place;
  return nearest + (place - nearest) * (kVertexOffMax / std::sqrt(least2));
}

}  // namespace

std::uint8_t cell_configuration(const ColumnWindow& window, const LatticeCell& cell) {
  unsigned configuration = 0;
  for (unsigned c = 0; c < 8; ++c) {
    const auto dx = static_cast<std::int32_t>(c & 1U);
    const auto dy = static_cast<std::int32_t>(c >> 1 & 1U);
    const auto dz = static_cast<std::int32_t>(c >> 2);
    const bool solid = window.solid(cell.x + dx, cell.y + dy, cell.layer - 1 + dz);
    configuration |= (solid ? 1U : 0U) << c;
  }
  return static_cast<std::uint8_t>(configuration);
}

VertexPlacement::VertexPlacement(const SolidSnapshot& solid, const ColumnWindow& window)
    : field_(solid.fields.front()),
      window_(window),
      guess_(window, solid.fields.front().stock()),
      steps_per_mm_(1 / window.grid().pitch_mm) {
  seen_->resize(kEdgesSeen);
  if (solid.fields.size() == 3) rays_.emplace(solid);
  const DexelGrid& grid = window.grid();
  const BoxStock box = stock_bounds(solid.fields.front().stock());
  const Vec3 size = (box.max_mm - box.min_mm) * (1 / grid.pitch_mm);
  is_box_ = std::holds_alternative<BoxStock>(solid.fields.front().stock());
  stock_low_ = {-0.5, -0.5, -window.level_zero()};
  stock_high_ = stock_low_ + size;
  margin_ = std::max(kMarginMin, std::max({size.x, size.y, size.z}) * kMarginOfSize);
  margin_below_ = std::min(margin_, size.z * kMarginOfHeight);
}

CellLimits VertexPlacement::limits_of(const LatticeCell& cell) const {
  const Vec3 center{cell.x + 0.5, cell.y + 0.5, cell.layer - 0.5};
  const auto within = [](double middle, double low, double high, double below, double above) {
    const double least = -0.5 + below, most = 0.5 - above;
    return std::pair(std::clamp(low - middle, least, most), std::clamp(high - middle, least, most));
  };
  const auto x = within(center.x, stock_low_.x, stock_high_.x, margin_, margin_);
  const auto y = within(center.y, stock_low_.y, stock_high_.y, margin_, margin_);
  const auto z = within(center.z, stock_low_.z, stock_high_.z, margin_below_, 0);
  return {{x.first, y.first, z.first}, {x.second, y.second, z.second}};
}

void VertexPlacement::upright(const LatticeCell& cell, int dx, int dy, Crossing& crossing) const {
  const std::int32_t i = cell.x + dx, j = cell.y + dy;
  const SolidRun& run = run_at(i, j, cell.layer);
  const bool top = run.end == cell.layer;
  crossing.point = {double(i), double(j), window_.steps(top ? run.top : run.bottom)};
  crossing.normal = top ? run.top_normal : run.bottom_normal;
  crossing.weight = 1;
  crossing.wall = false;
  crossing.original = top ? run.top_original : run.bottom_original;
}

/// Returns the lowest run of a column that ends at or above a layer.
const SolidRun& VertexPlacement::run_at(std::int32_t i, std::int32_t j, std::int32_t layer) const {
  const SolidRun* run = window_.runs(i, j).data();
  while (run->end < layer) ++run;
  return *run;
}

/// Returns whether a sample was solid before the first cut.
bool VertexPlacement::was_solid(std::int32_t i, std::int32_t j, std::int32_t k) const {
  const ColumnView column = field_.untouched_view(i, j);
  const std::int64_t level = window_.level(k);
  const auto holds = [level](const Dexel& e) { return e.bottom <= level && level < e.top; };
  return holds(column.topmost) || std::ranges::any_of(column.lower, holds);
}

SurfaceVertex VertexPlacement::flat_vertex(Vec3 place, Vec3 normal, bool original) const {
  const double pitch = window_.grid().pitch_mm;
  SurfaceVertex vertex;
  vertex.position_mm = {static_cast<float>((place.x + 0.5) * pitch),
                        static_cast<float>((place.y + 0.5) * pitch),
                        static_cast<float>((place.z + window_.level_zero()) * pitch)};
  vertex.normals[0] = {static_cast<float>(normal.x), static_cast<float>(normal.y),
                       static_cast<float>(normal.z)};
  vertex.original[0] = original;
  vertex.normal_count = 1;
  return vertex;
}

/// For a sheet that crosses exactly the four vertical edges of a cell.
std::optional<SurfaceVertex> VertexPlacement::place_on_floor(const LatticeCell& cell) const {
  std::int32_t depth = 0;
  Vec3 normal;
  bool original = true;
  for (int c = 0; c < 4; ++c) {
    const SolidRun& run = run_at(cell.x + (c & 1), cell.y + (c >> 1), cell.layer);
    const bool top = run.end == cell.layer;
    const std::int32_t here = top ? run.top : run.bottom;
    const Vec3& n = top ? run.top_normal : run.bottom_normal;
    if (std::abs(n.z) != 1 || (c > 0 && (here != depth || n.z != normal.z))) return std::nullopt;
    depth = here;
    normal = n;
    original = original && (top ? run.top_original : run.bottom_original);
  }
  return flat_vertex({cell.x + 0.5, cell.y + 0.5, window_.steps(depth)}, normal, original);
}

/// For a sheet that crosses exactly the four edges of a cell along X (or Y).
std::optional<SurfaceVertex> VertexPlacement::place_on_side(const LatticeCell& cell,
                                                            bool along_x) const {
  if (rays_ || !is_box_) return std::nullopt;
  const DexelGrid& grid = window_.grid();
  const bool low = (along_x ? cell.x : cell.y) == -1;
  const bool high = (along_x ? cell.x : cell.y) == (along_x ? grid.columns_x : grid.columns_y) - 1;
  if (!low && !high) return std::nullopt;
  for (int row = 0; row < 2; ++row) {
    const std::int32_t i = cell.x + (along_x ? (low ? 1 : 0) : row);
    const std::int32_t j = cell.y + (along_x ? row : (low ? 1 : 0));
    const SolidRun& run = run_at(i, j, cell.layer);
    // An element with oblique ends may end before the side.
    if (run.top_normal.z != 1 || run.bottom_normal.z != -1) return std::nullopt;
  }
  const CellLimits limits = limits_of(cell);
  Vec3 place{cell.x + 0.5, cell.y + 0.5, cell.layer - 0.5};
  if (along_x) {
    place.x += low ? limits.low.x : limits.high.x;
  } else {
    place.y += low ? limits.low.y : limits.high.y;
  }
  const double side = low ? -1 : 1;
  return flat_vertex(place, along_x ? Vec3{side, 0, 0} : Vec3{0, side, 0}, true);
}

const Crossing& VertexPlacement::level(std::int32_t i, std::int32_t j, std::int32_t k,
                                       bool along_x) {
  const std::int8_t axis = along_x ? 0 : 1;
  // Neighboring edges, including those of one row of cells, have different slots.
  const auto hash = (std::uint32_t(i) * 2 + std::uint32_t(axis)) ^ std::uint32_t(j) * 73U ^
                    std::uint32_t(k) * 593U;
  SeenEdge& seen = (*seen_)[hash % kEdgesSeen];
  if (seen.i == i && seen.j == j && seen.k == k && seen.axis == axis) return seen.crossing;
  std::optional<Crossing> exact;
  if (rays_) exact = rays_->find(i, j, k, along_x, window_.solid(i, j, k));
  seen = {i, j, k, axis, exact ? *exact : guess_.find(i, j, k, along_x)};
  if (!exact) {
    const bool leaves = window_.solid(i, j, k);
    seen.crossing.original =
        !was_solid(i + (leaves && along_x ? 1 : 0), j + (leaves && !along_x ? 1 : 0), k);
  }
  return seen.crossing;
}

SurfaceVertex VertexPlacement::place_on_edge(const LatticeEdge& edge) {
  Crossing crossing;
  if (edge.axis == 2) {
    upright({edge.i, edge.j, edge.k + 1}, 0, 0, crossing);
  } else {
    crossing = level(edge.i, edge.j, edge.k, edge.axis == 0);
  }
  const Vec3 along = crossing.point - Vec3{double(edge.i), double(edge.j), double(edge.k)};
  const double share = std::clamp(along.x + along.y + along.z, edge_margin(), 1 - edge_margin());
  Vec3 place{double(edge.i), double(edge.j), double(edge.k)};
  (edge.axis == 0 ? place.x : edge.axis == 1 ? place.y : place.z) += share;
  return flat_vertex(place, crossing.normal, crossing.original);
}

SurfaceVertex VertexPlacement::place_center(const LatticeEdge& edge,
                                            std::span<const std::array<float, 3>, 4> corners) {
  SurfaceVertex center = place_on_edge(edge);
  if (edge.axis == 2) return center;
  const double raise_mm = std::min(margin_, margin_below_) * kShareRaised / steps_per_mm_;
  const auto height = double(center.position_mm[2]);
  const auto level = std::ranges::count_if(corners, [&](const std::array<float, 3>& corner) {
    return std::abs(double(corner[2]) - height) <= raise_mm;
  });
  if (level == 2) center.position_mm[2] = static_cast<float>(height + raise_mm);
  return center;
}

std::array<double, 3> VertexPlacement::from_sample(const LatticeSample& sample,
                                                   const std::array<float, 3>& position_mm) const {
  return {double(position_mm[0]) * steps_per_mm_ - 0.5 - sample[0],
          double(position_mm[1]) * steps_per_mm_ - 0.5 - sample[1],
          double(position_mm[2]) * steps_per_mm_ - window_.level_zero() - sample[2]};
}

Vec3 VertexPlacement::beside_edge(const LatticeEdge& edge,
                                  const std::array<float, 3>& position_mm) const {
  const std::array<double, 3> p = from_sample({edge.i, edge.j, edge.k}, position_mm);
  const std::size_t a = (edge.axis + 1U) % 3, b = (edge.axis + 2U) % 3;
  return {p[a], p[b], p[edge.axis]};
}

void VertexPlacement::find_crossings(const LatticeCell& cell, std::uint16_t edges) {
  const Vec3 center{cell.x + 0.5, cell.y + 0.5, cell.layer - 0.5};
  Crossings& all = found_;
  all.count = 0;
  for (int e = 0; e < 12; ++e) {
    if ((edges >> e & 1) == 0) continue;
    const int a = e & 1, b = e >> 1 & 1;
    Crossing& c = all.at[all.count];
    if (e < 4) {
      c = level(cell.x, cell.y + a, cell.layer - 1 + b, true);
    } else if (e < 8) {
      c = level(cell.x + a, cell.y, cell.layer - 1 + b, false);
    } else {
      upright(cell, a, b, c);
    }
    c.point = c.point - center;
    all.edge[all.count++] = static_cast<std::uint8_t>(e);
  }
}

/// Returns the mean of the crossings found, each moved onto its edge, in pitches from the cell's
/// center.
Vec3 VertexPlacement::mean_on_edges() const {
  Vec3 sum;
  for (std::size_t n = 0; n < found_.count; ++n) {
    Vec3 p = found_.at[n].point;
    double& along = found_.edge[n] < 4 ? p.x : found_.edge[n] < 8 ? p.y : p.z;
    along = std::clamp(along, edge_margin() - 0.5, 0.5 - edge_margin());
    sum = sum + p;
  }
  return sum * (1 / double(found_.count));
}

/// Returns whether a cell has several sheets, or the one above it has or may have after a flip. Its
/// upper side may then have vertices of its own, and a vertex of the cell stays below it.
bool VertexPlacement::meets_sheets(const LatticeCell& cell, const CellSheets& sheets) const {
  if (sheets.count > 1) return true;
  const CellSheets& above =
      sheets_of(cell_configuration(window_, {cell.x, cell.y, cell.layer + 1}));
  return above.count > 1 || above.doubled_face >= 0;
}

SurfaceVertex VertexPlacement::place_alone(const LatticeCell& cell, const CellSheets& sheets,
                                           std::uint8_t sheet) {
  const std::uint16_t edges = sheets.edges[sheet];
  constexpr std::uint16_t kAlongX = 0x00f, kAlongY = 0x0f0, kUpright = 0xf00;
  std::optional<SurfaceVertex> flat;
  if (edges == kUpright) {
    flat = place_on_floor(cell);
  } else if (edges == kAlongX || edges == kAlongY) {
    flat = place_on_side(cell, edges == kAlongX);
  }
  if (flat) return *flat;
  find_crossings(cell, edges);
  const std::span<const Crossing> crossings(found_.at.data(), found_.count);
  const std::span<const std::uint8_t> edges_found(found_.edge.data(), found_.count);
  SheetPoint point = place_sheet(crossings, within_walls(crossings, edges_found, limits_of(cell)));
  if (point.sharp) point.place = near_surface(crossings, point.place);
  if (sheets.count > 1) point.place = on_own_side(sheets, sheet, mean_on_edges(), point.place);
  if (point.place.z > 0.5 - margin_ && meets_sheets(cell, sheets)) point.place.z = 0.5 - margin_;
  SurfaceVertex vertex;
  vertex.sharp = point.sharp;
  const DexelGrid& grid = window_.grid();
  const double z = cell.layer - 0.5 + point.place.z + window_.level_zero();
  vertex.position_mm = {static_cast<float>((cell.x + 1 + point.place.x) * grid.pitch_mm),
                        static_cast<float>((cell.y + 1 + point.place.y) * grid.pitch_mm),
                        static_cast<float>(z * grid.pitch_mm)};
  group_normals(crossings, edges_found, vertex);
  return vertex;
}

SurfaceVertex VertexPlacement::place(const LatticeCell& cell, const CellSheets& sheets,
                                     std::uint8_t sheet) {
  if (sheets.count == 1) return place_alone(cell, sheets, 0);
  std::array<SurfaceVertex, kSheetsMax> placed;
  const double pitch = window_.grid().pitch_mm;
  const auto center_x = static_cast<float>((cell.x + 1) * pitch);
  for (std::uint8_t n = 0; n <= sheet; ++n) {
    placed[n] = place_alone(cell, sheets, n);
    for (std::uint8_t before = 0; before < n; ++before) {
      if (placed[before].position_mm != placed[n].position_mm) continue;
      const auto shift = static_cast<float>(n * kSheetShift * pitch);
      float& x = placed[n].position_mm[0];
      x += x < center_x ? shift : -shift;
    }
  }
  return placed[sheet];
}

}  // namespace kerf
