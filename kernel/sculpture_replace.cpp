// SPDX-License-Identifier: Apache-2.0
// The part of Sculpture that replaces tiles, and finds the tools around which stock is restored.
#include <algorithm>
#include <memory>

#include "kernel/cut/cut.h"
#include "kernel/cut/lazy_normals.h"
#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/stock_column.h"
#include "kernel/dexel/tile_region.h"
#include "kernel/force/collision.h"
#include "kernel/force/engagement.h"
#include "kernel/sculpture.h"
#include "kernel/sculpture_check.h"
#include "kernel/sculpture_motion.h"
#include "kernel/sweep/swept_tool.h"
#include "kernel/tool/tool_bounds.h"

namespace kerf {
namespace {

/// The difference between two versions of a tile.
struct Difference {
  std::int64_t quanta = 0;                 ///< excess of the second over the first
  double border = 0;                       ///< additional quanta, by the shares of the columns
  std::int32_t low = INT32_MAX, high = 0;  ///< bounds of the columns that differ
  bool any() const { return low < high; }
};

std::int64_t length_of(std::span<const Dexel> column) {
  std::int64_t sum = 0;
  for (const Dexel& d : column) sum += d.top - d.bottom;
  return sum;
}

Difference difference(const DexelTile& before, const DexelTile& after, TileIndex at,
                      const ColumnShares& shares) {
  Difference sum;
  std::vector<Dexel> a, b;
  for (int column = 0; column < kTileColumns; ++column) {
    before.read(column, a);
    after.read(column, b);
    if (a == b) continue;
    const std::int64_t more = length_of(b) - length_of(a);
    sum.quanta += more;
    sum.border += double(more) * (shares.of(at.x * kTileSide + column % kTileSide,
                                            at.y * kTileSide + column / kTileSide) -
                                  1);
    for (const auto* elements : {&a, &b}) {
      if (elements->empty()) continue;
      sum.low = std::min(sum.low, elements->front().bottom);
      sum.high = std::max(sum.high, elements->back().top);
    }
  }
  return sum;
}

/// Appends the tiles of the field along Z whose surface depends on a tile of any field between two
/// depths.
void append_seen_tiles(const DexelGrid& grid, TileIndex at, const Difference& where,
                       std::vector<TileIndex>& changed) {
  if (grid.axis == RayAxis::kZ) {
    changed.push_back(at);
    return;
  }
  const double tile_quanta = kTileSide * grid.pitch_mm / grid.z_quantum_mm;
  const auto first = static_cast<std::int32_t>(where.low / tile_quanta);
  const auto last = static_cast<std::int32_t>(where.high / tile_quanta);
  for (std::int32_t t = first; t <= last; ++t) {
    changed.push_back(grid.axis == RayAxis::kX ? TileIndex{t, at.x} : TileIndex{at.y, t});
  }
}

}  // namespace

void Sculpture::cut_again(std::size_t field, std::span<const TileIndex> tiles,
                          const MotionSince& motion) {
  DexelField& at = fields_[field];
  const ToolMotion whole = in_frame(at.grid().axis, motion_of(motion.move, *motion.tool));
  sweep_tool(*motion.tool, whole, sweep_settings(at), [&](const SubMotion& part) {
    cut_tiles(at, normals_[field], *motion.tool, part, tiles, *removal_);
  });
}

ReplacedTiles Sculpture::replace(std::span<const TileReplacement> tiles,
                                 std::span<const MotionSince> since) {
  ReplacedTiles result;
  const auto untouched = std::make_unique<DexelTile>();
  for (const TileReplacement& tile : tiles) {
    const std::size_t n = place_of(tile.at.axis);
    DexelField& field = fields_[n];
    const auto form = [&](const DexelTile* stored) -> const DexelTile& {
      if (stored != nullptr) return *stored;
      fill_from_stock(field.stock(), field.grid(), tile.at.tile, *untouched);
      return *untouched;
    };
    if (field.find(tile.at.tile) == nullptr && !tile.tile) continue;
    normals_[n].resolve(field);  // pending ends may be in this tile
    const std::shared_ptr<const DexelTile> before = field.share(tile.at.tile);
    field.put_shared(tile.at.tile, tile.tile);
    for (const MotionSince& motion : since) cut_again(n, {&tile.at.tile, 1}, motion);
    // One of the two is stored.
    const DexelTile* after = field.find(tile.at.tile);
    const Difference changed =
        difference(form(before.get()), form(after), tile.at.tile, field.shares());
    if (!changed.any()) continue;
    append_seen_tiles(field.grid(), tile.at.tile, changed, result.changed_tiles);
    result.tiles.push_back(tile.at);
    result.returned_mm3 += (double(changed.quanta) + changed.border) * field.grid().quantum_mm3() /
                           static_cast<double>(fields_.size());
  }
  std::erase_if(result.changed_tiles, [this](TileIndex tile) { return !grid().has(tile); });
  std::ranges::sort(result.changed_tiles);
  const auto repeated = std::ranges::unique(result.changed_tiles);
  result.changed_tiles.erase(repeated.begin(), repeated.end());
  removed_mm3_ -= result.returned_mm3;
  for (const FieldTile& tile : result.tiles) forget_users(tile);
  return result;
}

bool Sculpture::is_in_stock(ToolId id, const ToolPose& given) const {
  const Tool* used = tool(id);
  if (used == nullptr || !check_pose("the", given)) return false;
  const ToolPose pose{given.tip_mm, normalized(given.axis)};
  const ToolMotion rest = make_motion(pose, pose, used->length_mm);
  Removal removal;
  bool cuts = false;
  for (const DexelField& field : fields_) {
    DexelField copy = field;
    (void)copy.snapshot();  // from now on the copy shares the tiles
    sweep_tool(*used, in_frame(field.grid().axis, rest), sweep_settings(field),
               [&](const SubMotion& standing) {
                 cut(copy, standing.swept, removal);
                 cuts = cuts || removal.quanta() > 0;
               });
    if (cuts) return true;
  }
  return false;
}

/// Forgets the users whose tools reach a tile.
void Sculpture::forget_users(const FieldTile& at) {
  const DexelGrid& grid = fields_[place_of(at.axis)].grid();
  const auto reaches = [&](ToolId id, const ToolPose& pose) {
    const Tool* used = tool(id);
    if (used == nullptr) return true;
    const Bounds box = tool_bounds(*used, pose);
    return tiles_through(grid, box.lo_mm, box.hi_mm).has(at.tile);
  };
  engagements_->forget_if(reaches);
  std::erase_if(last_pose_, [&](const auto& last) { return reaches(last.first, last.second); });
}

}  // namespace kerf
