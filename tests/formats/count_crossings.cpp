// SPDX-License-Identifier: Apache-2.0
// Counts, with exact predicates, the self-intersections and the facets without area of binary STL
// files. Exits with 1 if there are any, with 2 if a file cannot be read. Usage: count_crossings
// CELL_MM FILE.stl ... (CELL_MM: a typical size of the facets)

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <vector>

#include "tests/support/self_intersection.h"

namespace {

using kerf::TileMesh;

std::optional<TileMesh> read_stl(const char* path) {
  constexpr std::size_t kHeader = 84, kFacet = 50, kNormal = 12;
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  std::uint32_t facets = 0;
  if (bytes.size() < kHeader) return std::nullopt;
  std::memcpy(&facets, bytes.data() + kHeader - 4, 4);
  if (bytes.size() != kHeader + kFacet * facets) return std::nullopt;
  TileMesh mesh;
  for (std::size_t n = 0; n < facets; ++n) {
    std::array<std::array<float, 3>, 3> corners;
    std::memcpy(corners.data(), bytes.data() + kHeader + kFacet * n + kNormal, sizeof(corners));
    for (const auto& corner : corners) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions_mm.size()));
      mesh.positions_mm.push_back(corner);
    }
  }
  return mesh;
}

}  // namespace

int main(int argc, char** argv) {
  const double cell_mm = argc > 2 ? std::atof(argv[1]) : 0;
  if (!(cell_mm > 0)) return 2;
  bool any = false;
  for (int n = 2; n < argc; ++n) {
    const auto mesh = read_stl(argv[n]);
    if (!mesh) {
      std::fprintf(stderr, "%s is no binary STL file\n", argv[n]);
      return 2;
    }
    const auto found = kerf::test::count_self_intersections({*mesh}, cell_mm);
    std::printf("%s: %zu facets, %zu pairs intersect, %zu without area\n", argv[n], found.triangles,
                found.pairs, found.zero_area);
    any = any || found.pairs + found.zero_area > 0;
  }
  return any ? 1 : 0;
}
