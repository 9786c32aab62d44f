// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/page_block.h"

#include <algorithm>
#include <utility>

#include "kernel/dexel/stock_column.h"
#include "server/wire/codec.h"

namespace kerf::page {
namespace {

/// Adds a column, row-major, to those that have changed.
void add(int column, ChangedColumns& changed) {
  const std::int32_t x = column % kTileSide, y = column / kTileSide;
  changed.begin_x = std::min(changed.begin_x, x);
  changed.begin_y = std::min(changed.begin_y, y);
  changed.end_x = std::max(changed.end_x, x + 1);
  changed.end_y = std::max(changed.end_y, y + 1);
}

/// Returns where two forms of a tile differ; no columns: nowhere.
ChangedColumns difference(const DexelTile& a, const DexelTile& b, TileIndex at) {
  ChangedColumns changed{at, kTileSide, kTileSide, 0, 0};
  std::vector<Dexel> of_a, of_b;
  for (int column = 0; column < kTileColumns; ++column) {
    const auto c = std::size_t(column);
    const bool is_split = a.is_split(column) || b.is_split(column);
    if (!is_split && a.bottom[c] == b.bottom[c] && a.top[c] == b.top[c]) continue;
    a.read(column, of_a);
    b.read(column, of_b);
    if (of_a != of_b) add(column, changed);
  }
  return changed;
}

/// Appends where the tiles of one view have other columns in the other view.
void append_different(const DexelSnapshot& view, const DexelSnapshot& other,
                      std::vector<ChangedColumns>& different) {
  view.for_each_touched([&](TileIndex at, const DexelTile& tile) {
    const DexelTile* there = other.tiles().find(at);
    if (there == &tile) return;
    DexelTile untouched;
    if (there == nullptr) fill_from_stock(other.stock(), other.grid(), at, untouched);
    const ChangedColumns columns = difference(tile, there == nullptr ? untouched : *there, at);
    if (columns.end_x > 0) different.push_back(columns);
  });
}

/// Returns where two views of one block differ along Z. Both views keep their tiles, so that a tile
/// that was written since is another one.
std::vector<ChangedColumns> different_columns(const SolidSnapshot& a, const SolidSnapshot& b) {
  std::vector<ChangedColumns> different;
  append_different(a.fields.front(), b.fields.front(), different);
  append_different(b.fields.front(), a.fields.front(), different);
  return different;
}

}  // namespace

PageBlock::PageBlock(agent::Replica replica)
    : replica_(std::move(replica)), shown_(replica_.solid()) {}

std::expected<PageBlock, std::string> PageBlock::open(std::string_view welcome) {
  auto source = agent::BlockSource::read(welcome);
  if (!source) return std::unexpected(source.error());
  source->keep_normals();
  return PageBlock(agent::Replica(*std::move(source)));
}

bool PageBlock::take(std::span<const std::byte> frame) {
  const auto message = wire::decode(frame);
  if (!message) return false;
  if (const auto* motion = std::get_if<wire::MotionBatch>(&message->body)) {
    has_cut_ = true;
    force_n_ = 0;
    for (const wire::MotionSample& sample : motion->view()) {
      strokes_.move(replica_, sample, seen_);
      if (const agent::Replica::NewestCut* cut = replica_.newest_cut()) {
        const Vec3 force_n = cut->result.wrench.force_n - cut->result.collision.force_n;
        force_n_ = std::max(force_n_, length(force_n));
      }
    }
  } else if (const auto* stock = std::get_if<wire::StockPatch>(&message->body)) {
    const SolidSnapshot before = replica_.solid();
    if (!replica_.take(*stock)) return false;
    strokes_.take(replica_, *stock, before);
  } else if (const auto* result = std::get_if<wire::Result>(&message->body)) {
    replica_.compare(result->agent_time_us, Vec3(result->force_n));
    return !replica_.take_divergence();
  }
  return true;
}

void PageBlock::change(bool undone) {
  has_cut_ = true;
  strokes_.change(replica_, undone, seen_);
}

std::vector<ChangedTile> PageBlock::changed() {
  SolidSnapshot now = strokes_.solid(replica_);
  const SolidSnapshot before = std::exchange(shown_, now);
  std::vector<ChangedColumns> changed = different_columns(before, now);
  if (!has_cut_ && now.fields.size() > 1) {
    for (ChangedColumns& columns : changed) columns = {columns.tile};  // X and Y: anywhere
  }
  changed.insert(changed.end(), seen_.begin(), seen_.end());
  seen_.clear();
  for (const TileIndex tile : tiles_that_read(now.grid(), changed)) {
    bool& by_page = waiting_[tile];
    by_page = by_page || has_cut_;
  }
  has_cut_ = false;
  std::vector<ChangedTile> tiles;
  std::erase_if(waiting_, [&](const auto& tile) {
    const bool is_known = replica_.knows_around(tile.first);
    if (is_known) tiles.push_back({tile.first, tile.second});
    return is_known;
  });
  return tiles;
}

}  // namespace kerf::page
