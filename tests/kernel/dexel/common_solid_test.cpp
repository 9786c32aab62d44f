// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/common_solid.h"

#include "kernel/dexel/dexel_tile.h"
#include "tests/support/test.h"

namespace kerf::common_solid_test {
namespace {

constexpr std::int32_t kHeight = 40;

/// A column as one flag per quantum.
using Bits = std::array<bool, kHeight>;

std::vector<Dexel> elements_of(const Bits& bits) {
  std::vector<Dexel> out;
  for (std::int32_t z = 0; z < kHeight; ++z) {
    if (!bits[std::size_t(z)]) continue;
    if (!out.empty() && out.back().top == z) {
      ++out.back().top;
    } else {
      out.push_back({z, z + 1});
    }
  }
  return out;
}

TEST(CommonSolid, EqualsTheIntersectionQuantumByQuantum) {
  std::mt19937 random(3);
  for (const bool with_normals : {false, true}) {
    DexelTile a{}, b{};
    if (with_normals) {
      a.topmost_codes.resize(kTileColumns);
      b.topmost_codes.resize(kTileColumns);
    }
    std::vector<Bits> common(kTileColumns);
    for (int column = 0; column < kTileColumns; ++column) {
      // Some rows have one element per column, the remaining rows several.
      const bool plain = (column / kTileSide) % 2 == 0;
      const auto fill = [&](DexelTile& tile, Bits& bits) {
        if (plain) {
          const auto low = static_cast<std::int32_t>(random() % kHeight);
          const auto high = static_cast<std::int32_t>(random() % kHeight);
          for (std::int32_t z = low; z < high; ++z) bits[std::size_t(z)] = true;
        } else {
          for (bool& bit : bits) bit = random() % 3 != 0;
        }
        tile.write(column, elements_of(bits));
      };
      Bits left{}, right{};
      fill(a, left);
      fill(b, right);
      for (std::size_t z = 0; z < kHeight; ++z) {
        common[std::size_t(column)][z] = left[z] && right[z];
      }
    }
    keep_common(a, b);
    std::vector<Dexel> column_of_a;
    for (int column = 0; column < kTileColumns; ++column) {
      a.read(column, column_of_a);
      ASSERT_EQ(column_of_a, elements_of(common[std::size_t(column)])) << "column " << column;
    }
    EXPECT_EQ(a.block_top[0] <= kHeight, true);
  }
}

TEST(CommonSolid, EndsKeepTheNormalsOfTheirTiles) {
  DexelTile a{}, b{};
  a.topmost_codes.resize(kTileColumns);
  b.topmost_codes.resize(kTileColumns);
  const NormalCode x = encode_normal({1, 0, 0}), y = encode_normal({0, 1, 0});
  for (const int column : {0, kTileSide}) {
    // One element in the first row; two in the second.
    const std::vector<Dexel> one{{0, 30}}, two{{0, 10}, {12, 30}};
    a.write(column, column == 0 ? one : two);
    b.write(column, std::vector<Dexel>{{5, 20}});
    a.topmost_codes[std::size_t(column)] = {x, x};
    b.topmost_codes[std::size_t(column)] = {y, y};
  }
  a.lower_codes.assign(kTileSide, std::vector<EndCodes>{{x, x}});
  keep_common(a, b);
  EXPECT_EQ(a.topmost_codes[0], (EndCodes{y, y}));
  const ColumnView split = a.view(kTileSide);
  EXPECT_EQ(split.topmost_codes, (EndCodes{x, y}));
  ASSERT_EQ(split.lower_codes.size(), 1U);
  EXPECT_EQ(split.lower_codes.front(), (EndCodes{y, x}));
}

}  // namespace
}  // namespace kerf::common_solid_test
