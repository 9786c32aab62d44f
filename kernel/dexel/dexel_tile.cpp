// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/dexel_tile.h"

#include <algorithm>
#include <cstddef>

#include "kernel/math/int_lanes.h"

namespace kerf {
namespace {

/// Returns the greatest of 8 x 8 depths in rows kTileSide apart, at least 0.
KERF_INLINE std::int32_t highest_in_lanes(const std::int32_t* depths) {
  IntLanes all{};
  for (std::ptrdiff_t row = 0; row < 8; ++row) {
    all = greater(load_ints(depths + row * kTileSide), all);
  }
  std::int32_t greatest = 0;
  for (int c = 0; c < 8; ++c) greatest = all[c] > greatest ? all[c] : greatest;
  return greatest;
}
KERF_FOR_EACH_TARGET(std::int32_t, highest, (const std::int32_t* depths), (depths))

}  // namespace

void DexelTile::read(int column, std::vector<Dexel>& out) const {
  out.clear();
  if (is_split(column)) {
    const std::span<const Dexel> below = lower.of(column);
    out.assign(below.begin(), below.end());
  }
  const auto c = std::size_t(column);
  if (bottom[c] < top[c]) out.push_back({bottom[c], top[c]});
}

ColumnView DexelTile::view(int column) const {
  const auto c = std::size_t(column);
  ColumnView v{.lower = {}, .topmost = {bottom[c], top[c]}, .lower_codes = {}, .topmost_codes = {}};
  if (is_split(column)) v.lower = lower.of(column);
  if (keeps_normals()) {
    v.topmost_codes = topmost_codes[c];
    if (is_split(column)) v.lower_codes = lower_codes.of(column);
  }
  return v;
}

/// Copies the normal codes of ends that the new elements share with the present ones. Both lists
/// are sorted, so one pass up the column finds them.
void DexelTile::carry_codes(int column, std::span<const Dexel> dexels) {
  const ColumnView old = view(column);
  const std::size_t count = old.lower.size() + (old.topmost.bottom < old.topmost.top ? 1 : 0);
  const auto element = [&](std::size_t n) {
    return n < old.lower.size() ? old.lower[n] : old.topmost;
  };
  const auto codes = [&](std::size_t n) {
    return n < old.lower.size() ? old.lower_codes[n] : old.topmost_codes;
  };
  std::vector<EndCodes> carried(dexels.size());
  std::size_t b = 0, t = 0;
  for (std::size_t n = 0; n < dexels.size(); ++n) {
    while (b < count && element(b).bottom < dexels[n].bottom) ++b;
    while (t < count && element(t).top < dexels[n].top) ++t;
    if (b < count && element(b).bottom == dexels[n].bottom) carried[n].bottom = codes(b).bottom;
    if (t < count && element(t).top == dexels[n].top) carried[n].top = codes(t).top;
  }
  const std::size_t below = carried.empty() ? 0 : carried.size() - 1;
  topmost_codes[std::size_t(column)] = carried.empty() ? EndCodes{} : carried.back();
  lower_codes.assign(column, std::span(carried).first(below));
}

NormalCode* DexelTile::lower_top_code(int column, std::int32_t depth) {
  const std::span<const Dexel> below = lower.of(column);
  const auto found = std::ranges::lower_bound(below, depth, {}, &Dexel::top);
  if (found == below.end() || found->top != depth) return nullptr;
  return &lower_codes.edit(column)[std::size_t(found - below.begin())].top;
}

NormalCode* DexelTile::lower_bottom_code(int column, std::int32_t depth) {
  const std::span<const Dexel> below = lower.of(column);
  const auto found = std::ranges::lower_bound(below, depth, {}, &Dexel::bottom);
  if (found == below.end() || found->bottom != depth) return nullptr;
  return &lower_codes.edit(column)[std::size_t(found - below.begin())].bottom;
}

void DexelTile::write(int column, std::span<const Dexel> dexels) {
  if (keeps_normals()) carry_codes(column, dexels);
  const auto c = std::size_t(column);
  bottom[c] = dexels.empty() ? 0 : dexels.back().bottom;
  top[c] = dexels.empty() ? 0 : dexels.back().top;
  const bool many = dexels.size() > 1;
  if (!many && !is_split(column)) return;
  lower.assign(column, many ? dexels.first(dexels.size() - 1) : std::span<const Dexel>{});
  const std::uint32_t bit = 1u << (column % kTileSide);
  std::uint32_t& row = split[std::size_t(column / kTileSide)];
  row = many ? row | bit : row & ~bit;
}

void DexelTile::update_bounds() {
  for (int block = 0; block < kTileBlocks; ++block) update_bounds(block);
}

void DexelTile::update_bounds(int block) {
  const int first = block / kTileBlocksAcross * 8 * kTileSide + block % kTileBlocksAcross * 8;
  block_top[std::size_t(block)] = highest(&top[std::size_t(first)]);
}

}  // namespace kerf
