// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/tile_directory.h"

#include "kernel/dexel/dexel_tile.h"
#include "tests/support/test.h"

namespace kerf::tile_directory_test {
namespace {

DexelTile* put(TileDirectory& directory, TileIndex at, std::uint64_t era) {
  auto& slot = directory.slot(at, era);
  slot = std::make_shared<DexelTile>();
  return slot.get();
}

std::vector<TileIndex> places(const TileDirectory& directory) {
  std::vector<TileIndex> found;
  directory.for_each([&](TileIndex at, const DexelTile& tile) {
    EXPECT_EQ(directory.find(at), &tile);
    found.push_back(at);
  });
  return found;
}

TEST(TileDirectory, FindsExactlyTheStoredTiles) {
  TileDirectory directory(3125, 700);
  std::vector<TileIndex> put_at{{0, 0},   {15, 15}, {16, 15},  {15, 16},    {255, 255},
                                {256, 0}, {0, 256}, {1000, 3}, {3124, 699}, {511, 512}};
  std::vector<const DexelTile*> tiles;
  for (const TileIndex at : put_at) tiles.push_back(put(directory, at, 1));
  for (std::size_t i = 0; i < put_at.size(); ++i) EXPECT_EQ(directory.find(put_at[i]), tiles[i]);
  EXPECT_EQ(directory.find({1, 0}), nullptr);
  EXPECT_EQ(directory.find({3123, 699}), nullptr);
  EXPECT_EQ(directory.find({2000, 600}), nullptr);
  std::vector<TileIndex> found = places(directory);
  std::ranges::sort(found);
  std::ranges::sort(put_at);
  EXPECT_EQ(found, put_at);
}

TEST(TileDirectory, VisitOrderDoesNotDependOnHistory) {
  const std::vector<TileIndex> at{{5, 5}, {300, 2}, {17, 40}, {0, 0}};
  TileDirectory forward(400, 400), backward(400, 400);
  for (const TileIndex t : at) put(forward, t, 1);
  for (auto t = at.rbegin(); t != at.rend(); ++t) put(backward, *t, 1);
  EXPECT_EQ(places(forward), places(backward));
}

TEST(TileDirectory, CopySharesNodesUntilALaterEraChangesThem) {
  TileDirectory directory(400, 400);
  const DexelTile* first = put(directory, {7, 7}, 1);
  const TileDirectory copy = directory;
  const DexelTile* second = put(directory, {7, 7}, 2);
  put(directory, {350, 350}, 2);
  EXPECT_EQ(copy.find({7, 7}), first);
  EXPECT_EQ(copy.find({350, 350}), nullptr);
  EXPECT_EQ(directory.find({7, 7}), second);
}

TEST(TileDirectory, UntouchedTenMeterBlockTakesKilobytes) {
  TileDirectory directory(3125, 3125);
  EXPECT_LT(directory.bytes(), 4096u);
  put(directory, {1500, 1500}, 1);
  EXPECT_LT(directory.bytes(), 16384u);
}

}  // namespace
}  // namespace kerf::tile_directory_test
