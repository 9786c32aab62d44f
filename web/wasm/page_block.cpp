// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/page_block.h"

#include <algorithm>
#include <utility>

#include "server/wire/codec.h"

namespace kerf::page {
namespace {

/// Appends the tiles of one block that are other ones, or missing, in the other block.
void append_different(const TileDirectory& tiles, const TileDirectory& other,
                      std::vector<TileIndex>& different) {
  tiles.for_each([&](TileIndex at, const DexelTile& tile) {
    if (other.find(at) != &tile) different.push_back(at);
  });
}

/// Returns the tiles that are not shared by two views of one block. Both views keep their tiles, so
/// that a tile that was written since is another one.
std::vector<TileIndex> different_tiles(const SolidSnapshot& a, const SolidSnapshot& b) {
  std::vector<TileIndex> different;
  append_different(a.fields.front().tiles(), b.fields.front().tiles(), different);
  append_different(b.fields.front().tiles(), a.fields.front().tiles(), different);
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
    for (const wire::MotionSample& sample : motion->view()) replica_.move(sample);
  } else if (const auto* stock = std::get_if<wire::StockPatch>(&message->body)) {
    return replica_.take(*stock).has_value();
  } else if (const auto* result = std::get_if<wire::Result>(&message->body)) {
    replica_.compare(result->agent_time_us, Vec3(result->force_n));
    return !replica_.take_divergence();
  }
  return true;
}

std::vector<ChangedTile> PageBlock::changed() {
  SolidSnapshot now = replica_.solid();
  const SolidSnapshot before = std::exchange(shown_, now);
  for (const TileIndex tile : tiles_to_remesh(now.grid(), different_tiles(before, now))) {
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
