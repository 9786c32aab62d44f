#include "kernel/surface/vertex_placement.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace kerf {
namespace {

/// Steeper than this (height over pitch), two neighbouring ends are taken for a wall between them,
/// not for a slope. If it grows, shallow steps become ramps; if it shrinks, steep slopes become
/// stairs.
constexpr double kSlopeMax = 8;
/// A rise is a wall if it exceeds this multiple of the rises before and after it.
constexpr double kWallRiseRatio = 3;
/// Rises below this share of the pitch are never walls: no sample level need lie between their
/// ends.
constexpr double kWallRiseMin = 0.5;
/// A crossing keeps this distance from the columns that it lies between, in pitches, so that no two
/// vertices coincide.
constexpr double kFractionMin = 1.0 / 16;
/// A vertex keeps this distance from the lower border of its cell, in lattice steps; the upper
/// border belongs to it.
constexpr double kHeightMin = 1.0 / 1024;
/// Vertices of two sheets that coincide are moved apart by this share of the pitch.
constexpr double kSheetShift = 1.0 / 64;
/// Faces whose normals differ by more than this (its cosine) meet in a crease and are shaded apart.
constexpr double kCreaseCosine = 0.5;
/// Rows on each side of a wall's crossing that take part in the line fitted to the wall.
constexpr int kWallRows = 2;
/// A sum of unit normals shorter than this has no direction.
constexpr double kNormalMin = 1e-6;

Vec3 mean(Vec3 sum, int count) { return {sum.x / count, sum.y / count, sum.z / count}; }

}  // namespace

/// Where the surface passes between two neighbouring columns at a sample level.
struct VertexPlacement::Side {
  double fraction = 0.5;  ///< from the column with the lower index
  bool wall = true;
  bool at_grid_border = false;
  int rows = 0;  ///< neighbouring rows that see the same wall; without any its direction is a guess
  Vec3 normal;
};

struct VertexPlacement::Sums {
  int crossings = 0, level_crossings = 0, upright_crossings = 0;
  bool has_wall = false;
  Vec3 all, level;       ///< sums of points; x and y in pitches from column 0, z in quanta
  double upright_z = 0;  ///< quanta
  std::optional<double> border_x, border_y;
  int rows_x = 0, rows_y = 0;
  Vec3 floor, wall_x, wall_y;  ///< sums of normals: ends and slopes, walls across x, walls across y
};

namespace {

std::array<float, 3> unit_float(Vec3 sum) {
  // The normals of a thin wall's two faces may cancel; any direction is as good as another there.
  const Vec3 n = length(sum) > kNormalMin ? normalized(sum) : Vec3{0, 0, 1};
  return {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
}

/// Gives both sums the same direction unless they meet in a crease or one of them is empty.
bool blend(Vec3& a, Vec3& b) {
  const double la = length(a);
  const double lb = length(b);
  if (la <= kNormalMin || lb <= kNormalMin || dot(a, b) < kCreaseCosine * la * lb) return false;
  a = a + b;
  b = a;
  return true;
}

/// The normals that faces across edges along x, y and z see, from the sums of one vertex's
/// crossings.
std::array<std::array<float, 3>, 3> normals_by_axis(Vec3 floor, Vec3 wall_x, Vec3 wall_y) {
  const bool has_floor = floor != Vec3{};
  const bool has_x = wall_x != Vec3{};
  const bool has_y = wall_y != Vec3{};
  if (!has_x && !has_y) {
    const auto normal = unit_float(floor);
    return {normal, normal, normal};
  }
  const bool one_wall = blend(wall_x, wall_y);
  if (blend(floor, wall_x) && one_wall) wall_y = wall_x;
  if (!one_wall) blend(floor, wall_y);
  // An axis without a wall of its own has slopes only, or no edge at all.
  const Vec3 any = has_floor ? floor : has_x ? wall_x : wall_y;
  return {unit_float(has_x ? wall_x : any), unit_float(has_y ? wall_y : any), unit_float(any)};
}

}  // namespace

VertexPlacement::VertexPlacement(const ColumnWindow& window)
    : window_(window),
      steps_per_quantum_(1 / window.quanta_per_step()),
      normals_(window.run_count() * 2) {}

/// True where the rise from an end in column (i, j) to the matching end one step further is a wall:
/// too steep, or out of proportion to the rises on both of its sides.
bool VertexPlacement::is_wall(std::int32_t i, std::int32_t j, std::int32_t step_x,
                              std::int32_t step_y, DexelEnd kind, std::int32_t near,
                              std::int32_t far) const {
  const double rise = std::abs(far - near) * steps_per_quantum_;
  if (rise <= kWallRiseMin) return false;
  if (rise > kSlopeMax) return true;
  double around = 0;
  if (const auto before = window_.nearest_end(i - step_x, j - step_y, kind, near)) {
    around = std::abs(near - *before) * steps_per_quantum_;
  }
  if (const auto after = window_.nearest_end(i + 2 * step_x, j + 2 * step_y, kind, far)) {
    around = std::max(around, std::abs(*after - far) * steps_per_quantum_);
  }
  return rise > kWallRiseRatio * around;
}

/// Height over pitch along +x or +y, from the neighbours whose ends continue this one; 0 where none
/// does.
double VertexPlacement::end_slope(std::int32_t i, std::int32_t j, std::int32_t step_x,
                                  std::int32_t step_y, DexelEnd kind, std::int32_t height) const {
  double sum = 0;
  int count = 0;
  for (const int sign : {-1, 1}) {
    const auto end = window_.nearest_end(i + sign * step_x, j + sign * step_y, kind, height);
    if (!end) continue;
    if (*end != height && is_wall(i, j, sign * step_x, sign * step_y, kind, height, *end)) continue;
    sum += sign * (*end - height) * steps_per_quantum_;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

Vec3 VertexPlacement::end_normal(std::int32_t i, std::int32_t j, DexelEnd kind, std::size_t run) {
  const bool top = kind == DexelEnd::kTop;
  EndNormal& cached = normals_[2 * (window_.run_number(i, j) + run) + (top ? 1U : 0U)];
  if (!cached.known) {
    const SolidRun& r = window_.runs(i, j)[run];
    const std::int32_t height = top ? r.top : r.bottom;
    const double slope_x = end_slope(i, j, 1, 0, kind, height);
    const double slope_y = end_slope(i, j, 0, 1, kind, height);
    const double sign = top ? 1 : -1;
    const bool level = slope_x == 0 && slope_y == 0;
    // Kept as doubles: GCC 12's vectoriser forgets to round a double that goes through a float and
    // back (-O2 and above), which would make the mesh depend on the optimisation level.
    cached.normal = level ? Vec3{0, 0, sign} : normalized({-sign * slope_x, -sign * slope_y, sign});
    cached.known = true;
  }
  return cached.normal;
}

/// Where the wall stands in the row of column (i, j), in columns from the crossing looked for, read
/// from the two columns on each side of it: -1, 0 or 1; 2 if the row shows no wall there.
int VertexPlacement::wall_offset(std::int32_t i, std::int32_t j, bool along_x, std::int32_t sample,
                                 bool reversed) const {
  int solid = 0;
  for (int n = -1; n <= 2; ++n) {
    const bool here =
        window_.solid(i + (along_x ? n : 0), j + (along_x ? 0 : n), sample) != reversed;
    if (here && solid != n + 1) return 2;  // solid again behind a gap
    solid += here ? 1 : 0;
  }
  return solid == 0 || solid == 4 ? 2 : solid - 2;
}

/// Columns know a wall only to half a pitch: a slanted one would become a staircase. So a line is
/// fitted to where the neighbouring rows see it, as far as they do.
void VertexPlacement::fit_wall(Side& side, std::int32_t i, std::int32_t j, bool along_x,
                               std::int32_t sample, bool reversed) const {
  int count = 1, sum_r = 0, sum_rr = 0, sum_w = 0, sum_rw = 0;  // the crossing itself: r = 0, w = 0
  for (const int direction : {-1, 1}) {
    for (int n = 1; n <= kWallRows; ++n) {
      const int row = direction * n;
      const int w =
          wall_offset(i + (along_x ? 0 : row), j + (along_x ? row : 0), along_x, sample, reversed);
      if (w == 2) break;
      ++count;
      sum_r += row;
      sum_rr += row * row;
      sum_w += w;
      sum_rw += row * w;
    }
  }
  side.rows = count - 1;
  if (sum_w == 0 && sum_rw == 0) return;
  const double determinant = count * sum_rr - sum_r * sum_r;
  const double offset = (sum_rr * sum_w - sum_r * sum_rw) / determinant;
  const double slope = (count * sum_rw - sum_r * sum_w) / determinant;
  side.fraction = std::clamp(0.5 + offset, kFractionMin, 1 - kFractionMin);
  const double sign = reversed ? -1 : 1;
  side.normal = normalized(along_x ? Vec3{sign, -sign * slope, 0} : Vec3{-sign * slope, sign, 0});
}

VertexPlacement::Side VertexPlacement::side_crossing(std::int32_t i, std::int32_t j, bool along_x,
                                                     std::int32_t sample) {
  std::int32_t step_x = along_x ? 1 : 0;
  std::int32_t step_y = along_x ? 0 : 1;
  const bool reversed = !window_.solid(i, j, sample);  // the solid column has the higher index
  Side side;
  side.normal = {(reversed ? -1.0 : 1.0) * step_x, (reversed ? -1.0 : 1.0) * step_y, 0};
  side.at_grid_border = !window_.in_grid(i, j) || !window_.in_grid(i + step_x, j + step_y);
  if (side.at_grid_border) {
    side.rows = 2 * kWallRows;
    return side;
  }
  fit_wall(side, i, j, along_x, sample, reversed);
  if (reversed) {
    i += step_x;
    j += step_y;
    step_x = -step_x;
    step_y = -step_y;
  }
  const std::int32_t level = window_.level(sample);
  const auto solid_runs = window_.runs(i, j);
  std::size_t run = 0;
  while (solid_runs[run].end <= sample) ++run;
  // The surface leaves the solid column's element through its top or its bottom towards an end of
  // the empty column.
  const auto empty_runs = window_.runs(i + step_x, j + step_y);
  std::optional<std::size_t> below, above;
  for (std::size_t n = 0; n < empty_runs.size(); ++n) {
    if (empty_runs[n].end <= sample) below = n;
    if (empty_runs[n].first > sample && !above) above = n;
  }
  const double rise_top =
      below ? static_cast<double>(solid_runs[run].top) - empty_runs[*below].top : 0;
  const double rise_bottom =
      above ? static_cast<double>(empty_runs[*above].bottom) - solid_runs[run].bottom : 0;
  const bool top = below && (!above || rise_top <= rise_bottom);
  if (!top && !above) return side;
  const DexelEnd kind = top ? DexelEnd::kTop : DexelEnd::kBottom;
  const std::size_t far_run = top ? *below : *above;
  const std::int32_t near = top ? solid_runs[run].top : solid_runs[run].bottom;
  const std::int32_t far = top ? empty_runs[far_run].top : empty_runs[far_run].bottom;
  if (is_wall(i, j, step_x, step_y, kind, near, far)) return side;
  const double fraction =
      std::clamp(static_cast<double>(near - level) / (near - far), kFractionMin, 1 - kFractionMin);
  side.wall = false;
  side.fraction = reversed ? 1 - fraction : fraction;
  side.normal = end_normal(i, j, kind, run) + end_normal(i + step_x, j + step_y, kind, far_run);
  side.normal = normalized(side.normal);
  return side;
}

void VertexPlacement::add_upright(Sums& sums, const LatticeCell& cell, int dx, int dy) {
  const std::int32_t i = cell.x + dx;
  const std::int32_t j = cell.y + dy;
  const auto runs = window_.runs(i, j);
  std::size_t run = 0;
  while (runs[run].end < cell.layer) ++run;
  const DexelEnd kind = runs[run].end == cell.layer ? DexelEnd::kTop : DexelEnd::kBottom;
  const double z = kind == DexelEnd::kTop ? runs[run].top : runs[run].bottom;
  sums.all = sums.all + Vec3{static_cast<double>(i), static_cast<double>(j), z};
  sums.upright_z += z;
  sums.floor = sums.floor + end_normal(i, j, kind, run);
  ++sums.crossings;
  ++sums.upright_crossings;
}

void VertexPlacement::add_level(Sums& sums, const LatticeCell& cell, bool along_x, int across,
                                int dz) {
  const std::int32_t i = cell.x + (along_x ? 0 : across);
  const std::int32_t j = cell.y + (along_x ? across : 0);
  const std::int32_t sample = cell.layer - 1 + dz;
  const Side side = side_crossing(i, j, along_x, sample);
  const Vec3 point{i + (along_x ? side.fraction : 0), j + (along_x ? 0 : side.fraction),
                   static_cast<double>(window_.level(sample))};
  if (side.at_grid_border) (along_x ? sums.border_x : sums.border_y) = along_x ? point.x : point.y;
  sums.has_wall |= side.wall;
  sums.all = sums.all + point;
  sums.level = sums.level + point;
  Vec3& normal = !side.wall ? sums.floor : along_x ? sums.wall_x : sums.wall_y;
  normal = normal + side.normal;
  if (side.wall) (along_x ? sums.rows_x : sums.rows_y) += side.rows;
  ++sums.crossings;
  ++sums.level_crossings;
}

SurfaceVertex VertexPlacement::place(const LatticeCell& cell, std::uint16_t edges) {
  Sums sums;
  for (int e = 0; e < 4; ++e) {
    if ((edges >> e & 1) != 0) add_level(sums, cell, true, e & 1, e >> 1);
    if ((edges >> (e + 4) & 1) != 0) add_level(sums, cell, false, e & 1, e >> 1);
    if ((edges >> (e + 8) & 1) != 0) add_upright(sums, cell, e & 1, e >> 1);
  }
  Vec3 p = mean(sums.all, sums.crossings);
  if (sums.has_wall) {
    // A wall stands where its own crossings are, and a floor or a ceiling that meets it keeps its
    // height: sharp creases.
    p = mean(sums.level, sums.level_crossings);
    if (sums.upright_crossings > 0) p.z = sums.upright_z / sums.upright_crossings;
  }
  if (sums.border_x) p.x = *sums.border_x;
  if (sums.border_y) p.y = *sums.border_y;
  const double low = window_.level(cell.layer - 1);
  const double high = window_.level(cell.layer);
  p.z = std::clamp(p.z, low + kHeightMin * (high - low), high);
  SurfaceVertex vertex;
  const DexelGrid& grid = window_.grid();
  vertex.position_mm = {static_cast<float>((p.x + 0.5) * grid.pitch_mm),
                        static_cast<float>((p.y + 0.5) * grid.pitch_mm),
                        static_cast<float>(p.z * grid.z_quantum_mm)};
  if (sums.wall_x != Vec3{} && sums.wall_y != Vec3{}) {
    // The jog of a slanted wall: the side that sees only the jog follows the one that sees the
    // wall.
    if (sums.rows_x == 0 && sums.rows_y > 0) sums.wall_x = sums.wall_y;
    if (sums.rows_y == 0 && sums.rows_x > 0) sums.wall_y = sums.wall_x;
  }
  vertex.normal_of = normals_by_axis(sums.floor, sums.wall_x, sums.wall_y);
  return vertex;
}

SurfaceVertex VertexPlacement::place_sheet(const LatticeCell& cell, const CellSheets& sheets,
                                           std::uint8_t sheet) {
  std::array<SurfaceVertex, kSheetsMax> placed;
  const double pitch = window_.grid().pitch_mm;
  const auto center_x = static_cast<float>((cell.x + 1) * pitch);
  for (std::uint8_t n = 0; n <= sheet; ++n) {
    placed[n] = place(cell, sheets.edges[n]);
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
