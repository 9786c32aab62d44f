// SPDX-License-Identifier: Apache-2.0
#include "server/verify/column_sets.h"

#include <algorithm>
#include <cstdint>

namespace kerf {

void subtract(std::span<const Dexel> whole, std::span<const Dexel> taken,
              std::vector<Dexel>& rest) {
  rest.clear();
  auto first = taken.begin();
  for (const Dexel& element : whole) {
    std::int32_t bottom = element.bottom;
    while (first != taken.end() && first->top <= bottom) ++first;
    for (auto at = first; at != taken.end() && at->bottom < element.top; ++at) {
      if (at->bottom > bottom) rest.push_back({bottom, at->bottom});
      bottom = std::max(bottom, at->top);
    }
    if (bottom < element.top) rest.push_back({bottom, element.top});
  }
}

void intersect(std::span<const Dexel> a, std::span<const Dexel> b, std::vector<Dexel>& common) {
  common.clear();
  for (auto x = a.begin(), y = b.begin(); x != a.end() && y != b.end();) {
    const Dexel both{std::max(x->bottom, y->bottom), std::min(x->top, y->top)};
    if (both.bottom < both.top) common.push_back(both);
    x->top < y->top ? ++x : ++y;
  }
}

}  // namespace kerf
