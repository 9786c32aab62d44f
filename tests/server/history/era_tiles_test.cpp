// SPDX-License-Identifier: Apache-2.0
#include "server/history/era_tiles.h"

#include "kernel/dexel/dexel_tile.h"
#include "tests/support/test.h"

namespace kerf::era_tiles_test {
namespace {

FieldTile tile_at(int x) { return {RayAxis::kZ, {x, 0}}; }

TEST(EraTiles, LongJournalsHaveLongerErasAndNoCache) {
  EraTiles eras;
  eras.of(tile_at(1), 0) = {true, nullptr, {3}, 20, 1};
  eras.of(tile_at(1), 1) = {true, nullptr, {}, 9000, 1};
  eras.grow(EraTiles::kErasMax * EraTiles::kRecords);
  EXPECT_TRUE(eras.of(tile_at(1), 0).is_carved);
  eras.grow(EraTiles::kErasMax * EraTiles::kRecords + 1);
  EXPECT_EQ(eras.length(), 2 * EraTiles::kRecords);
  EXPECT_FALSE(eras.of(tile_at(1), 0).is_carved)
      << "the second era may hold the stroke that the first was carved without";
}

TEST(EraTiles, AllEntriesCountAndTheOldestGoFirst) {
  EraTiles eras;
  const std::size_t none = eras.bytes();
  for (int n = 0; n < 100; ++n) eras.of(tile_at(n), 5);
  EXPECT_GE(eras.bytes(), none + 100 * sizeof(EraTile));
  eras.forget_oldest(SIZE_MAX);
  EXPECT_EQ(eras.bytes(), none) << "what is not carved is forgotten";
  const auto tile = std::make_shared<DexelTile>();
  for (int n = 0; n < 4; ++n) {
    eras.of(tile_at(n), 5) = {true, n % 2 == 0 ? tile : nullptr, {}, 1, std::uint64_t(10 - n)};
  }
  eras.forget_oldest(tile->bytes() + 1000);
  EXPECT_TRUE(eras.of(tile_at(0), 5).is_carved);
  EXPECT_TRUE(eras.of(tile_at(1), 5).is_carved);
  EXPECT_FALSE(eras.of(tile_at(2), 5).is_carved);
  eras.forget_oldest(0);
  EXPECT_EQ(eras.bytes(), none);
}

}  // namespace
}  // namespace kerf::era_tiles_test
