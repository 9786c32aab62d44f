// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/removal.h"

#include <array>

namespace kerf {

double border_quanta(std::span<const RemovedGroup> groups, const ColumnShares& shares) {
  if (groups.empty() || shares.are_whole(tile_of(groups.front()))) return 0;
  double sum = 0;
  std::array<double, RemovedGroup::kLanes> of{};
  for (const RemovedGroup& g : groups) {
    if (!shares.of_group(g.i, g.j, of)) continue;
    for (int c = 0; c < RemovedGroup::kLanes; ++c)
      sum += (of[std::size_t(c)] - 1) * (g.top[c] - g.bottom[c]);
  }
  return sum;
}

}  // namespace kerf
