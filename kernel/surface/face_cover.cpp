// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/face_cover.h"

#include <algorithm>
#include <cmath>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/math/tolerance.h"
#include "kernel/surface/column_window.h"
#include "kernel/surface/level_guess.h"

namespace kerf {
namespace {

/// Number of quadrangles around a cut whose vertices may depend on it.
constexpr std::int32_t kInfluence = kGuessMargin + 1;
/// Pitches above and below a carved end of a column at which its tangent plane may still be met
/// between the column and the stock's side, in addition to the plane's slope.
constexpr double kSlopeMargin = 2;

/// Interleaves the bits of u and v (G. Morton, 1966).
std::uint64_t morton(std::int32_t u, std::int32_t v) {
  const auto spread = [](std::int32_t n) {
    std::uint64_t bits = static_cast<std::uint32_t>(n);
    bits = (bits | bits << 16U) & 0x0000FFFF0000FFFFU;
    bits = (bits | bits << 8U) & 0x00FF00FF00FF00FFU;
    bits = (bits | bits << 4U) & 0x0F0F0F0F0F0F0F0FU;
    bits = (bits | bits << 2U) & 0x3333333333333333U;
    return (bits | bits << 1U) & 0x5555555555555555U;
  };
  return spread(u) | spread(v) << 1U;
}

/// Calls visit(column in the tile, i, j) for the columns of a tile within `columns_x` x `columns_y`
/// until it returns false.
template <class Visit>
void for_columns(TileIndex tile, std::int32_t columns_x, std::int32_t columns_y, Visit&& visit) {
  const std::int32_t i0 = tile.x * kTileSide, j0 = tile.y * kTileSide;
  for (std::int32_t j = j0; j < std::min(j0 + kTileSide, columns_y); ++j) {
    for (std::int32_t i = i0; i < std::min(i0 + kTileSide, columns_x); ++i) {
      if (!visit((j - j0) * kTileSide + i - i0, i, j)) return;
    }
  }
}

struct LowestAndTopmost {
  Dexel lowest, topmost;
  NormalCode bottom, top;
};
LowestAndTopmost ends_of(const ColumnView& view) {
  const bool split = !view.lower.empty();
  const NormalCode lowest_code = !split                     ? view.topmost_codes.bottom
                                 : view.lower_codes.empty() ? kStockNormal
                                                            : view.lower_codes.front().bottom;
  return {split ? view.lower.front() : view.topmost, view.topmost, lowest_code,
          view.topmost_codes.top};
}

/// Returns how far above and below an end its tangent plane may be met within one pitch, in
/// pitches.
double reach(Vec3 normal) {
  const double aside = std::sqrt(normal.x * normal.x + normal.y * normal.y);
  return aside == 0 ? 0 : aside / std::max(std::abs(normal.z), kUprightMin) + kSlopeMargin;
}

}  // namespace

FaceCover::FaceCover(const SolidSnapshot& solid) {
  const DexelGrid& grid = solid.grid();
  const StockShape& stock = solid.fields.front().stock();
  quads_ = {grid.columns_x, grid.columns_y, ColumnWindow(solid, 0, 0, 1).samples()};
  patches_ = patches_of(quads_);
  const auto* cylinder = std::get_if<CylinderStock>(&stock);
  for (const StockFace face : kStockFaces) {
    active_[face.index()] = face.axis == 2 || cylinder == nullptr;
  }
  if (cylinder != nullptr) block_outside(*cylinder, grid);
  read_columns(solid);
  for (std::size_t n = 1; n < solid.fields.size() && cylinder == nullptr; ++n) {
    read_rays(solid.fields[n]);
  }
  for (auto& codes : blocked_) {
    std::ranges::sort(codes);
    const auto tail = std::ranges::unique(codes);
    codes.erase(tail.begin(), tail.end());
  }
}

/// Marks a patch that a cut has reached, and patches with vertices that may depend on it.
void FaceCover::block(StockFace face, std::int32_t u, std::int32_t v) {
  FaceRange quads{face, {}, {}};
  quads.low[face.u_axis()] = u * kTileSide;
  quads.low[face.v_axis()] = v * kTileSide;
  quads.high[face.u_axis()] = (u + 1) * kTileSide;
  quads.high[face.v_axis()] = (v + 1) * kTileSide;
  for_unfolded(quads.within(quads_).grown(kInfluence), quads_, [this](const FaceRange& r) {
    if (!active_[r.face.index()]) return;
    const std::size_t ua = r.face.u_axis(), va = r.face.v_axis();
    for (std::int32_t pv = r.low[va] / kTileSide; pv <= (r.high[va] - 1) / kTileSide; ++pv) {
      for (std::int32_t pu = r.low[ua] / kTileSide; pu <= (r.high[ua] - 1) / kTileSide; ++pu) {
        blocked_[r.face.index()].push_back(morton(pu, pv));
      }
    }
  });
}

/// Reads the field along Z, which determines top and bottom, and the solid samples at the sides.
void FaceCover::read_columns(const SolidSnapshot& solid) {
  const DexelSnapshot& field = solid.fields.front();
  const ColumnWindow levels(solid, 0, 0, 1);
  const std::int64_t lowest = levels.level(0), topmost = levels.level(quads_[2] - 1);
  field.for_each_touched([&](TileIndex at, const DexelTile& tile) {
    bool bottom = true, top = true;
    for_columns(at, quads_[0], quads_[1], [&](int column, std::int32_t, std::int32_t) {
      const LowestAndTopmost ends = ends_of(tile.view(column));
      bottom = bottom && ends.lowest.bottom == 0 && ends.lowest.top > lowest &&
               ends.bottom == kStockNormal;
      top = top && ends.topmost.top == field.grid().height_quanta &&
            ends.topmost.bottom <= topmost && ends.top == kStockNormal;
      return bottom || top;
    });
    if (!bottom) block({2, false}, at.x, at.y);
    if (!top) block({2, true}, at.x, at.y);
    if (active_[StockFace{0, false}.index()]) read_sides(solid, at);
  });
}

void FaceCover::read_sides(const SolidSnapshot& solid, TileIndex tile) {
  for (const StockFace face : kStockFaces) {
    if (face.axis == 2) continue;
    const std::int32_t last = patches_[face.axis] - 1;
    if ((face.axis == 0 ? tile.x : tile.y) != (face.high ? last : 0)) continue;
    std::vector<bool> cut(static_cast<std::size_t>(patches_[2]));
    const std::int32_t at = face.high ? quads_[face.axis] - 1 : 0;
    for_columns(tile, quads_[0], quads_[1], [&](int, std::int32_t i, std::int32_t j) {
      if ((face.axis == 0 ? i : j) == at) read_side_column(ColumnWindow(solid, i, j, 1), i, j, cut);
      return true;
    });
    for (std::int32_t n = 0; n < patches_[2]; ++n) {
      if (!cut[static_cast<std::size_t>(n)]) continue;
      face.axis == 0 ? block(face, tile.y, n) : block(face, n, tile.x);
    }
  }
}

/// Marks the patches of a side where the column next to it is not solid, or where the tangent plane
/// of one of its ends may pass between it and the side.
void FaceCover::read_side_column(const ColumnWindow& column, std::int32_t i, std::int32_t j,
                                 std::vector<bool>& cut) const {
  const auto mark = [&](std::int32_t first, std::int32_t end) {
    for (std::int32_t n = first / kTileSide; n * kTileSide < end; ++n) {
      cut[static_cast<std::size_t>(n)] = true;
    }
  };
  const auto sample = [this](double steps) {
    return static_cast<std::int32_t>(std::clamp(std::ceil(steps), 0.0, double(quads_[2])));
  };
  std::int32_t above = 0;  // samples from here on are not yet judged
  for (const SolidRun& run : column.runs(i, j)) {
    const double low = reach(run.bottom_normal), high = reach(run.top_normal);
    const std::int32_t first =
        low == 0 ? run.first : std::max(run.first, sample(column.steps(run.bottom) + low));
    const std::int32_t end =
        high == 0 ? run.end : std::min(run.end, sample(column.steps(run.top) - high));
    if (first >= end) continue;
    if (above < first) mark(above, first);
    above = end;
  }
  if (above < quads_[2]) mark(above, quads_[2]);
}

/// Reads the field along X or Y, whose rays end in the two sides perpendicular to it.
void FaceCover::read_rays(const DexelSnapshot& field) {
  const auto axis = static_cast<std::uint8_t>(field.grid().axis);
  const StockFace low{axis, false}, high{axis, true};
  const std::int32_t rays_u = std::min(quads_[low.u_axis()], field.grid().columns_x);
  const std::int32_t rays_v = std::min(quads_[low.v_axis()], field.grid().columns_y);
  field.for_each_touched([&](TileIndex at, const DexelTile& tile) {
    bool low_is_stock = true, high_is_stock = true;
    for_columns(at, rays_u, rays_v, [&](int ray, std::int32_t, std::int32_t) {
      const LowestAndTopmost ends = ends_of(tile.view(ray));
      low_is_stock = low_is_stock && ends.lowest.bottom == 0 &&
                     ends.lowest.top > ends.lowest.bottom && ends.bottom == kStockNormal;
      high_is_stock = high_is_stock && ends.topmost.top == field.grid().height_quanta &&
                      ends.top == kStockNormal;
      return low_is_stock || high_is_stock;
    });
    if (!low_is_stock && at.x < patches_[low.u_axis()] && at.y < patches_[low.v_axis()]) {
      block(low, at.x, at.y);
    }
    if (!high_is_stock && at.x < patches_[low.u_axis()] && at.y < patches_[low.v_axis()]) {
      block(high, at.x, at.y);
    }
  });
}

/// Marks the tiles that are not entirely within a cylinder. A disc is convex, so corners decide.
void FaceCover::block_outside(const CylinderStock& stock, const DexelGrid& grid) {
  const auto within = [&](std::int32_t i, std::int32_t j) {
    const double x = grid.x_mm(i) - stock.center_x_mm, y = grid.y_mm(j) - stock.center_y_mm;
    return x * x + y * y < stock.radius_mm * stock.radius_mm;
  };
  for (std::int32_t v = 0; v < patches_[1]; ++v) {
    for (std::int32_t u = 0; u < patches_[0]; ++u) {
      const std::int32_t i0 = u * kTileSide - kInfluence, i1 = (u + 1) * kTileSide + kInfluence;
      const std::int32_t j0 = v * kTileSide - kInfluence, j1 = (v + 1) * kTileSide + kInfluence;
      if (within(i0, j0) && within(i1, j0) && within(i0, j1) && within(i1, j1)) continue;
      for (const bool high : {false, true}) {
        blocked_[StockFace{2, high}.index()].push_back(morton(u, v));
      }
    }
  }
}

int FaceCover::root_level(StockFace face) const {
  const std::int32_t most = std::max(patches_[face.u_axis()], patches_[face.v_axis()]);
  int level = 0;
  while (std::int32_t{1} << level < most) ++level;
  return level;
}

/// Returns whether a blocked patch is in the nodes of a level that contain a range.
bool FaceCover::is_cut(const FaceRange& patches, int level) const {
  const auto& codes = blocked_[patches.face.index()];
  const std::size_t ua = patches.face.u_axis(), va = patches.face.v_axis();
  for (std::int32_t v = patches.low[va] >> level; v <= (patches.high[va] - 1) >> level; ++v) {
    for (std::int32_t u = patches.low[ua] >> level; u <= (patches.high[ua] - 1) >> level; ++u) {
      const std::uint64_t node = morton(u, v);
      const auto found = std::ranges::lower_bound(codes, node << (2 * level));
      if (found != codes.end() && *found >> (2 * level) == node) return true;
    }
  }
  return false;
}

/// A patch is a square if it is not blocked. A larger node is a square if nothing is blocked up to
/// its own size around it, so neighboring squares differ by at most one level.
bool FaceCover::is_square(StockFace face, const FaceNode& node) const {
  const FaceRange patches = node.range(face, patches_);
  if (node.level == 0) return !is_cut(patches, 0);
  bool free = true;
  for_unfolded(patches.grown(1 << node.level), patches_, [&](const FaceRange& r) {
    free = free && !(active_[r.face.index()] && is_cut(r, node.level));
  });
  return free;
}

int FaceCover::level_at(StockFace face, std::int32_t u, std::int32_t v) const {
  if (!covers(face, u, v)) return -1;
  const int root = root_level(face);
  int level = 0;
  while (level < root && is_square(face, {level + 1, u >> (level + 1), v >> (level + 1)})) ++level;
  return level;
}

}  // namespace kerf
