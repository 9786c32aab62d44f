#include "kernel/dexel/dexel_tile.h"

#include <algorithm>

namespace kerf {
namespace {

bool before(const DexelTile::Lower& lower, int column) { return lower.column < column; }

}  // namespace

void DexelTile::read(int column, std::vector<Dexel>& out) const {
  out.clear();
  if (is_split(column)) {
    auto it = std::lower_bound(lower.begin(), lower.end(), column, before);
    for (; it != lower.end() && it->column == column; ++it) out.push_back(it->dexel);
  }
  const auto c = std::size_t(column);
  if (bottom[c] < top[c]) out.push_back({bottom[c], top[c]});
}

void DexelTile::write(int column, std::span<const Dexel> dexels) {
  const auto c = std::size_t(column);
  bottom[c] = dexels.empty() ? 0 : dexels.back().bottom;
  top[c] = dexels.empty() ? 0 : dexels.back().top;

  const std::uint32_t bit = 1u << (column % kTileSide);
  std::uint32_t& row = split[std::size_t(column / kTileSide)];
  auto first = std::lower_bound(lower.begin(), lower.end(), column, before);
  if (row & bit) {
    auto last = first;
    while (last != lower.end() && last->column == column) ++last;
    first = lower.erase(first, last);
  }
  row &= ~bit;
  if (dexels.size() < 2) return;
  row |= bit;
  std::vector<Lower> added;
  for (const Dexel& d : dexels.first(dexels.size() - 1)) {
    added.push_back({static_cast<std::uint16_t>(column), d});
  }
  lower.insert(first, added.begin(), added.end());
}

}  // namespace kerf
