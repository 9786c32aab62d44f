#include "kernel/dexel/dexel_tile.h"

#include <algorithm>

#include "kernel/math/lanes.h"

namespace kerf {
namespace {

/// Greatest of each row of a block of 8 x 8 depths.
KERF_VECTOR_CLONES
void highest_of_rows(const std::int32_t* depths, std::int32_t* greatest) {
  for (int row = 0; row < 8; ++row) {
    std::int32_t all = 0;
    for (int c = 0; c < 8; ++c) {
      const std::int32_t depth = depths[row * kTileSide + c];
      all = depth > all ? depth : all;
    }
    greatest[row] = all;
  }
}

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

void DexelTile::write(int column, std::span<const Dexel> dexels) {
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
  std::int32_t rows[8];
  row_tops(block, rows);
  block_top[std::size_t(block)] = *std::max_element(rows, rows + 8);
}

void DexelTile::row_tops(int block, std::int32_t* tops) const {
  const int first = block / kTileBlocksAcross * 8 * kTileSide + block % kTileBlocksAcross * 8;
  highest_of_rows(&top[std::size_t(first)], tops);
}

}  // namespace kerf
