// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/own_strokes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/dexel/common_solid.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/stock_column.h"
#include "kernel/tool/tool_bounds.h"
#include "server/convert/tool_track.h"

namespace kerf::page {
namespace {

using TilePtr = std::shared_ptr<const DexelTile>;

FieldTile place_of(const wire::StockTile& tile) {
  return {static_cast<RayAxis>(tile.axis),
          {static_cast<std::int32_t>(tile.x), static_cast<std::int32_t>(tile.y)}};
}

/// Returns a tile of a view, which must have its field; null: untouched.
TilePtr tile_of(const SolidSnapshot& solid, FieldTile at) {
  const auto field = std::ranges::find(solid.fields, at.axis,
                                       [](const DexelSnapshot& one) { return one.grid().axis; });
  return field->tiles().share(at.tile);
}

/// Returns a copy of a tile, which any field may share; null of an untouched one.
std::shared_ptr<DexelTile> copy_of(const TilePtr& tile) {
  if (!tile) return nullptr;
  auto copy = std::make_shared<DexelTile>(*tile);
  copy->era = 0;
  return copy;
}

/// Returns a copy of a tile, also of an untouched one.
std::shared_ptr<DexelTile> stored(const TilePtr& tile, TileIndex at, const DexelField& field) {
  if (tile) return copy_of(tile);
  auto stock = std::make_shared<DexelTile>();
  fill_from_stock(field.stock(), field.grid(), at, *stock);
  stock->topmost_codes.resize(kTileColumns);
  return stock;
}

/// Returns what a tile holds and another form of it does not.
std::shared_ptr<DexelTile> rest_of(const TilePtr& tile, const TilePtr& other, TileIndex at,
                                   const DexelField& field) {
  auto rest = stored(tile, at, field);
  remove_common(*rest, *stored(other, at, field));
  return rest;
}

void put(Sculpture& block, FieldTile at, const TilePtr& tile) {
  const TileReplacement replacement{at, copy_of(tile)};
  block.replace({&replacement, 1});
}

bool is_empty(const DexelTile& tile) {
  return std::ranges::equal(tile.bottom, tile.top);  // topmost elements, below which others are
}

/// Returns the columns of a tile that lie in a box or a column beside it.
ChangedColumns columns_within(const DexelGrid& grid, TileIndex tile, const Bounds& box) {
  const auto column = [&grid](double at_mm, double origin_mm, std::int32_t of_tile, int more) {
    const double n = std::floor((at_mm - origin_mm) / grid.pitch_mm) + more - of_tile * kTileSide;
    return static_cast<std::int32_t>(std::clamp(n, 0.0, double{kTileSide}));
  };
  const Vec3& from = grid.origin_mm;
  return {tile, column(box.lo_mm.x, from.x, tile.x, -1), column(box.lo_mm.y, from.y, tile.y, -1),
          column(box.hi_mm.x, from.x, tile.x, 2), column(box.hi_mm.y, from.y, tile.y, 2)};
}

}  // namespace

bool OwnStrokes::is_pending(FieldTile at) const {
  return std::ranges::any_of(pending_, [at](const auto& tiles) { return tiles.contains(at); });
}

void OwnStrokes::begin_stroke() {
  in_stroke_ = true;
  undone_.clear();
  std::size_t tiles = 0;
  for (const Stroke& stroke : done_) tiles += stroke.other.size();
  for (; tiles > kTilesMax; done_.pop_front()) tiles -= done_.front().other.size();
  done_.emplace_back();
}

void OwnStrokes::move(agent::Replica& replica, const wire::MotionSample& sample,
                      std::vector<ChangedColumns>& seen) {
  if (!cuts(sample)) in_stroke_ = false;
  if (!base_ || !in_stroke_) base_ = cuts(sample) ? std::optional(solid(replica)) : std::nullopt;
  replica.move(sample);
  const agent::Replica::NewestCut* cut = replica.newest_cut();
  if (cut == nullptr) return;
  MotionResult ahead;
  if (ahead_) {
    MoveTool unfelt = cut->move;
    unfelt.feel = false;
    ahead = ahead_->apply(unfelt).value();  // the replica has accepted it
  }
  const MotionResult& result = ahead_ ? ahead : cut->result;
  if (!in_stroke_) begin_stroke();
  Stroke& stroke = done_.back();
  for (const FieldTile& at : result.cut_tiles) {
    if (!stroke.is_known || stroke.other.contains(at)) continue;
    stroke.other.emplace(at, tile_of(*base_, at));
  }
  if (replica.block().settings().rays == Rays::kDexel) return;
  const Tool& tool = *replica.block().tool(cut->move.tool);
  const Bounds box = joined(tool_bounds(tool, cut->move.from), tool_bounds(tool, cut->move.to));
  for (const TileIndex tile : result.changed_tiles) {
    seen.push_back(columns_within(replica.block().grid(), tile, box));
  }
}

void OwnStrokes::change(agent::Replica& replica, bool undone, std::vector<ChangedColumns>& seen) {
  in_stroke_ = false;
  base_.reset();
  auto& from = undone ? done_ : undone_;
  auto& to = undone ? undone_ : done_;
  Stroke stroke{.is_known = false};
  if (!from.empty()) {
    stroke = std::move(from.back());
    from.pop_back();
  }
  std::set<FieldTile>& named = pending_.emplace_back();
  if (stroke.is_known) {
    if (!ahead_) ahead_.emplace(replica.copy());
    const SolidSnapshot before = ahead_->solid();
    std::vector<TileReplacement> tiles;
    for (auto& [at, form] : stroke.other) {
      named.insert(at);
      tiles.push_back({at, copy_of(std::exchange(form, tile_of(before, at)))});
    }
    const ReplacedTiles replaced = ahead_->replace(tiles);
    if (replica.block().settings().rays != Rays::kDexel) {
      for (const TileIndex tile : replaced.changed_tiles) seen.push_back({tile});
    }
  }
  to.push_back(std::move(stroke));
  end_if_done();
}

void OwnStrokes::take(agent::Replica& replica, const wire::StockPatch& patch,
                      const SolidSnapshot& before) {
  base_.reset();
  if (patch.reset) {
    forget_all();
    end();
  } else if (patch.returned) {
    take_returned(replica, patch);
  } else {
    take_tiles(replica, patch, before);
  }
}

/// Takes what others have cut out of all that is kept of these tiles.
void OwnStrokes::take_tiles(agent::Replica& replica, const wire::StockPatch& patch,
                            const SolidSnapshot& before) {
  const SolidSnapshot now = replica.solid();
  for (const wire::StockTile& tile : patch.tiles) {
    const FieldTile at = place_of(tile);
    const DexelField& field = *replica.block().field(at.axis);
    const TilePtr is = tile_of(now, at);
    const bool was_awaited = awaited_.erase(at) > 0;
    const TilePtr was = tile_of(was_awaited ? ahead_->solid() : before, at);
    if (was != is) take_away(at, field, was, is);
    if (!ahead_) continue;
    if (!is_pending(at)) {
      put(*ahead_, at, is);
    } else if (was != is) {
      put(*ahead_, at,
          rest_of(tile_of(ahead_->solid(), at), rest_of(was, is, at.tile, field), at.tile, field));
    }
  }
  end_if_done();
}

/// Others have cut what a tile was, and is no more.
void OwnStrokes::take_away(FieldTile at, const DexelField& field, const TilePtr& was,
                           const TilePtr& is) {
  TilePtr gone;
  for (std::deque<Stroke>* strokes : {&done_, &undone_}) {
    for (Stroke& stroke : *strokes) {
      const auto kept = stroke.other.find(at);
      if (kept == stroke.other.end()) continue;
      if (!gone) gone = rest_of(was, is, at.tile, field);
      if (is_empty(*gone)) return;
      kept->second = rest_of(kept->second, gone, at.tile, field);
    }
  }
}

/// Takes tiles to which stock has come back, or from which it was taken again: by a request of the
/// page, unless it expected none of them.
void OwnStrokes::take_returned(agent::Replica& replica, const wire::StockPatch& patch) {
  for (const wire::StockTile& tile : patch.tiles) {
    if (!is_pending(place_of(tile))) return take_foreign(patch);
  }
  const SolidSnapshot now = replica.solid(), expected = ahead_->solid();
  for (const wire::StockTile& tile : patch.tiles) {
    const FieldTile at = place_of(tile);
    std::ranges::find_if(pending_, [at](const auto& tiles) {
      return tiles.contains(at);
    })->erase(at);
    if (is_pending(at)) continue;  // in another form
    if (!replica.knows(at)) {
      awaited_.insert(at);
      continue;
    }
    const TilePtr was = tile_of(expected, at), is = tile_of(now, at);
    const DexelField& field = *replica.block().field(at.axis);
    if (!is_empty(*rest_of(is, was, at.tile, field))) forget(at);  // another stroke was undone
    take_away(at, field, was, is);
    put(*ahead_, at, is);
  }
  end_if_done();
}

/// Stock has come back that strokes of others had taken, or strokes of which nothing is known here.
void OwnStrokes::take_foreign(const wire::StockPatch& patch) {
  for (const wire::StockTile& tile : patch.tiles) forget(place_of(tile));
  settle();
}

/// What is kept of this tile is out of date.
void OwnStrokes::forget(FieldTile at) {
  for (std::deque<Stroke>* strokes : {&done_, &undone_}) {
    for (Stroke& stroke : *strokes) {
      if (stroke.other.contains(at)) stroke.forget();
    }
  }
}

void OwnStrokes::forget_all() {
  done_.clear();
  undone_.clear();
  if (in_stroke_) done_.push_back({.is_known = false});
}

void OwnStrokes::settle() {
  if (!pending_.empty()) forget_all();  // The server may have changed others than expected.
  for (const FieldTile& at : awaited_) forget(at);
  end();
}

void OwnStrokes::end_if_done() {
  std::erase_if(pending_, [](const auto& tiles) { return tiles.empty(); });
  if (pending_.empty() && awaited_.empty()) end();
}

void OwnStrokes::end() {
  pending_.clear();
  awaited_.clear();
  base_.reset();
  ahead_.reset();
}

}  // namespace kerf::page
