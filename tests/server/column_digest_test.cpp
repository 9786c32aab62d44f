// SPDX-License-Identifier: Apache-2.0
#include "server/feed/column_digest.h"

#include "server/feed/tile_feed.h"
#include "tests/support/carvings.h"
#include "tests/support/glb_reader.h"
#include "tests/support/test.h"

namespace kerf::column_digest_test {
namespace {

const BoxStock kBlock{{-3, 2, 0}, {74, 82, 12}};

Sculpture block_of(Rays rays) {
  return std::move(Sculpture::create({.stock = kBlock, .rays = rays, .pitch_mm = 0.5}).value());
}

std::map<TileIndex, std::uint64_t> digests_of(const SolidSnapshot& solid) {
  std::map<TileIndex, std::uint64_t> digests;
  for (std::int32_t y = 0; y < solid.grid().tiles_y(); ++y) {
    for (std::int32_t x = 0; x < solid.grid().tiles_x(); ++x) {
      digests[{x, y}] = column_digest(solid, {x, y});
    }
  }
  return digests;
}

class ColumnDigest : public testing::TestWithParam<Rays> {};

TEST_P(ColumnDigest, DependsOnContentsNotOnPosition) {
  Sculpture sculpture = block_of(GetParam());
  const auto digests = digests_of(sculpture.solid());
  EXPECT_EQ(digests.at({1, 1}), digests.at({2, 3}));
  EXPECT_NE(digests.at({1, 1}), digests.at({4, 1})) << "the last one has fewer columns";
}

TEST_P(ColumnDigest, ChangesWhereTheBlockDoesAndNowhereElse) {
  Sculpture sculpture = block_of(GetParam());
  test::RandomCarver carver(sculpture, kBlock.min_mm, kBlock.max_mm, 3);
  auto before = digests_of(sculpture.solid());
  std::uint64_t hash = sculpture.state_hash();
  int changes = 0;
  for (int n = 0; n < 60; ++n) {
    const auto changed = carver.cut();
    const auto after = digests_of(sculpture.solid());
    for (const auto& [tile, digest] : after) {
      if (digest == before.at(tile)) continue;
      ++changes;
      // Rays along X and Y have tiles of their own, up to one beyond those of the field along Z.
      const auto is_near = [&](TileIndex other) {
        return std::abs(other.x - tile.x) <= 1 && std::abs(other.y - tile.y) <= 1;
      };
      EXPECT_TRUE(std::ranges::any_of(changed, is_near));
    }
    EXPECT_EQ(after != before, sculpture.state_hash() != hash);
    before = after;
    hash = sculpture.state_hash();
  }
  EXPECT_GT(changes, 60);
}

INSTANTIATE_TEST_SUITE_P(Rays, ColumnDigest, testing::Values(Rays::kDexel, Rays::kTriDexel));

/// A viewer that verifies digests: stores the newest digest of each tile.
class Screen {
 public:
  Screen(TileFeed& feed, std::optional<ViewerLook> look)
      : feed_(feed), viewer_(feed.add_viewer(look, TileNodes::kVerified)) {}

  void drain() {
    while (const auto frame = feed_.next_frame(viewer_)) {
      const auto decoded = test::read_mesh_glb(*frame->glb);
      for (const auto& [index, tile] : decoded.tiles) digests_[index] = tile.digest;
      feed_.ack(viewer_, frame->sequence);
    }
  }
  const std::map<TileIndex, std::uint64_t>& digests() const { return digests_; }

 private:
  TileFeed& feed_;
  ViewerId viewer_;
  std::map<TileIndex, std::uint64_t> digests_;
};

TEST_P(ColumnDigest, ViewersTilesHaveTheBlocksDigests) {
  Sculpture sculpture = block_of(GetParam());
  test::RandomCarver carver(sculpture, kBlock.min_mm, kBlock.max_mm, 9);
  TileFeed feed(sculpture.solid(), 0);
  Screen near(feed, std::nullopt), far(feed, ViewerLook{{37, 40, 3000}, 0.001});
  for (int n = 0; n < 30; ++n) {
    near.drain();
    far.drain();
    EXPECT_EQ(near.digests(), digests_of(sculpture.solid()));
    EXPECT_EQ(far.digests(), near.digests());
    const auto changed = carver.cut();
    feed.note_change(sculpture.solid(), changed, sculpture.motions());
  }
}

}  // namespace
}  // namespace kerf::column_digest_test
