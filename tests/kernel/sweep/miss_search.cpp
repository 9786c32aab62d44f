// SPDX-License-Identifier: Apache-2.0
// Searches for motions whose sweep misses material, and prints each case that is worse than all
// before. Fails if more than the tolerance is missed. Usage: miss_search [climbs=1000] [seed=1]

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "tests/kernel/sweep/missed_depth.h"

int main(int argc, char** argv) {
  using namespace kerf::test;
  const long climbs = argc > 1 ? std::atol(argv[1]) : 1000;
  MissSearch search(argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 1);
  double worst = 0;
  for (long k = 0; k < climbs; ++k) {
    double depth = 0;
    const MissCase c = search.climb(depth);
    if (depth <= worst && depth <= 1) continue;
    std::printf("climb %ld, depth / tolerance %.4f: {%d, %g, {", k, depth, c.tool, c.top_mm);
    for (const double g : c.genes) std::printf("%.9g, ", g);
    std::printf("}}\n");
    std::fflush(stdout);
    worst = std::max(worst, depth);
  }
  std::printf("%ld climbs, worst %.4f of the tolerance\n", climbs, worst);
  return worst <= 1 ? 0 : 1;
}
