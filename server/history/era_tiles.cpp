// SPDX-License-Identifier: Apache-2.0
#include "server/history/era_tiles.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "kernel/dexel/common_solid.h"
#include "kernel/dexel/dexel_tile.h"

namespace kerf {
namespace {

std::size_t bytes_of(const EraTile& era) { return era.tile ? era.tile->bytes() : 0; }

/// What two eras together leave of a tile; not carved unless both are.
EraTile joined(const EraTile& a, const EraTile& b) {
  EraTile both;
  if (!a.is_carved || !b.is_carved) return both;
  both.is_carved = true;
  both.tile = a.tile ? a.tile : b.tile;
  if (a.tile && b.tile) {
    auto common = std::make_shared<DexelTile>(*a.tile);
    keep_common(*common, *b.tile);
    both.tile = std::move(common);
  }
  both.last = b.last;
  both.used = std::min(a.used, b.used);
  std::ranges::set_union(a.without, b.without, std::back_inserter(both.without));
  return both;
}

}  // namespace

void EraTiles::grow(std::uint64_t records) {
  while (records > kErasMax * length_) join_pairs();
}

void EraTiles::join_pairs() {
  for (auto& [at, eras] : tiles_) {
    Eras pairs(kErasMax);
    for (std::size_t n = 0; n < kErasMax / 2; ++n) pairs[n] = joined(eras[2 * n], eras[2 * n + 1]);
    eras = std::move(pairs);
  }
  length_ *= 2;
}

EraTile& EraTiles::of(FieldTile at, std::size_t era) {
  Eras& eras = tiles_[at];
  eras.resize(kErasMax);
  return eras[era];
}

std::size_t EraTiles::bytes() const {
  std::size_t bytes = 0;
  for (const auto& [at, eras] : tiles_) {
    for (const EraTile& era : eras) bytes += bytes_of(era);
  }
  return bytes;
}

void EraTiles::forget_oldest(std::size_t bytes) {
  std::size_t held = this->bytes();
  if (held <= bytes) return;
  std::vector<EraTile*> kept;
  for (auto& [at, eras] : tiles_) {
    for (EraTile& era : eras) {
      if (era.tile) kept.push_back(&era);
    }
  }
  std::ranges::sort(kept, {}, &EraTile::used);
  for (EraTile* era : kept) {
    if (held <= bytes) return;
    held -= bytes_of(*era);
    *era = {};
  }
}

}  // namespace kerf
