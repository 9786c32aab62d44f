// SPDX-License-Identifier: Apache-2.0
#include "server/feed/tile_runs.h"

#include "server/feed/tile_feed.h"
#include "tests/support/carvings.h"
#include "tests/support/glb_reader.h"
#include "tests/support/test.h"

namespace kerf::tile_runs_test {
namespace {

/// The surfaces seen by two viewers of one feed, tile by tile.
struct Surfaces {
  std::map<TileIndex, test::DecodedTile> tiles;
  std::size_t bytes = 0, nodes = 0;

  void drain(TileFeed& feed, ViewerId viewer, double tile_mm) {
    while (auto frame = feed.next_frame(viewer)) {
      bytes += frame->glb->size();
      auto decoded = test::read_mesh_glb(*frame->glb, tile_mm);
      nodes += decoded.nodes;
      for (auto& [index, tile] : decoded.tiles) tiles[index] = std::move(tile);
      ASSERT_TRUE(feed.ack(viewer, frame->sequence));
    }
  }
};

/// Positions may differ by rounding in sums.
void expect_same_surface(const Surfaces& one, const Surfaces& other) {
  ASSERT_EQ(one.tiles.size(), other.tiles.size());
  for (const auto& [index, tile] : one.tiles) {
    const auto& copy = other.tiles.at(index);
    EXPECT_EQ(copy.version, tile.version);
    EXPECT_EQ(copy.level, tile.level);
    EXPECT_EQ(copy.indices, tile.indices);
    ASSERT_EQ(copy.positions_mm.size(), tile.positions_mm.size());
    for (std::size_t n = 0; n < tile.positions_mm.size(); ++n) {
      EXPECT_LT(length(copy.positions_mm[n] - tile.positions_mm[n]), 0.0001);
    }
  }
}

TEST(TileFeedRepeat, OneNodeStandsForARectangleOfEqualTiles) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, 0}, {400, 400, 8}}, 0.5);
  const double tile_mm = kTileSide * 0.5;
  TileFeed feed(sculpture.solid(), 0);
  const ViewerLook look{{200, 200, 3000}, 0.001};
  const ViewerId plain = feed.add_viewer(look);
  const ViewerId repeated = feed.add_viewer(look, TileNodes::kRepeated);
  Surfaces singles, rectangles;
  singles.drain(feed, plain, tile_mm);
  rectangles.drain(feed, repeated, tile_mm);
  EXPECT_EQ(singles.nodes, 625U);
  EXPECT_LT(rectangles.nodes, 60U);
  EXPECT_LT(rectangles.bytes, singles.bytes / 3);
  expect_same_surface(singles, rectangles);
}

TEST(TileFeedRepeat, CarvedTilesAreNotPartOfARectangle) {
  Sculpture sculpture = test::make_sculpture(CylinderStock{0, 0, 120, 0, 8}, 0.5);
  test::RandomCarver carver(sculpture, {-60, -60, 0}, {60, 60, 8}, 7);
  for (int n = 0; n < 30; ++n) carver.cut();
  const double tile_mm = kTileSide * 0.5;
  TileFeed feed(sculpture.solid(), 0);
  Surfaces singles, rectangles;
  singles.drain(feed, feed.add_viewer(), tile_mm);
  rectangles.drain(feed, feed.add_viewer(std::nullopt, TileNodes::kRepeated), tile_mm);
  EXPECT_LT(rectangles.nodes, singles.nodes);
  expect_same_surface(singles, rectangles);
}

}  // namespace
}  // namespace kerf::tile_runs_test
