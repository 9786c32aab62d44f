// SPDX-License-Identifier: Apache-2.0
#include "server/history/era_tiles.h"

#include <algorithm>
#include <vector>

#include "kernel/dexel/dexel_tile.h"

namespace kerf {
namespace {

/// Approximate bytes of an entry with its map node.
constexpr std::size_t kEntryBytes = sizeof(EraTile) + 64;

std::size_t bytes_of(const EraTile& era) {
  return kEntryBytes + era.without.capacity() * sizeof(StrokeId) +
         (era.tile ? era.tile->bytes() : 0);
}

}  // namespace

void EraTiles::grow(std::uint64_t records) {
  if (records <= kErasMax * length_) return;
  tiles_.clear();
  while (records > kErasMax * length_) length_ *= 2;
}

std::size_t EraTiles::bytes() const {
  std::size_t bytes = 0;
  for (const auto& [at, eras] : tiles_) {
    for (const auto& [n, era] : eras) bytes += bytes_of(era);
  }
  return bytes;
}

void EraTiles::forget_oldest(std::size_t bytes) {
  struct Kept {
    std::uint64_t used;
    FieldTile at;
    std::size_t era, bytes;
  };
  std::vector<Kept> kept;
  std::size_t held = 0;
  for (auto& [at, eras] : tiles_) {
    std::erase_if(eras, [](const auto& entry) { return !entry.second.is_carved; });
    for (const auto& [n, era] : eras) {
      kept.push_back({era.used, at, n, bytes_of(era)});
      held += kept.back().bytes;
    }
  }
  if (held > bytes) std::ranges::sort(kept, {}, &Kept::used);
  for (const Kept& oldest : kept) {
    if (held <= bytes) break;
    held -= oldest.bytes;
    tiles_[oldest.at].erase(oldest.era);
  }
  std::erase_if(tiles_, [](const auto& tile) { return tile.second.empty(); });
}

}  // namespace kerf
