// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/feed/tile_feed.h"
#include "tests/support/glb_reader.h"
#include "tests/support/mesh_check.h"
#include "tests/support/test.h"

namespace kerf::test {

/// A viewer that stores the newest version of every tile and fails if a version decreases.
class Screen {
 public:
  void apply(const FeedFrame& frame) {
    bytes_ += frame.glb->size();
    for (auto& [index, tile] : read_mesh_glb(*frame.glb).tiles) {
      EXPECT_GE(tile.version, tiles_[index].version);
      if (tile.version == tiles_[index].version) ++same_version_;
      tiles_[index] = std::move(tile);
    }
  }
  /// Applies and acknowledges all frames. Returns their number.
  std::size_t drain(TileFeed& feed, ViewerId viewer) {
    std::size_t frames = 0;
    while (auto frame = feed.next_frame(viewer)) {
      ++frames;
      apply(*frame);
      EXPECT_TRUE(feed.ack(viewer, frame->sequence));
    }
    return frames;
  }
  void expect_equal(const SolidSnapshot& snapshot) const {
    const MeshQuantization quantization = mesh_quantization(snapshot.grid());
    for (const TileMesh& mesh : mesh_all(snapshot)) {
      const EncodedTile plain = encode_tile(mesh, quantization, 1);
      const EncodedTile* pointer = &plain;
      const auto expected = read_mesh_glb(write_mesh_glb({&pointer, 1}, quantization, 0, 0));
      ASSERT_EQ(triangles_of(tiles_.at(mesh.tile)), triangles_of(expected.tiles.at(mesh.tile)));
    }
  }
  std::size_t tiles() const { return tiles_.size(); }
  std::size_t triangles() const {
    std::size_t count = 0;
    for (const auto& [index, tile] : tiles_) count += tile.indices.size() / 3;
    return count;
  }
  std::map<int, int> levels() const {
    std::map<int, int> count;
    for (const auto& [index, tile] : tiles_) ++count[tile.level];
    return count;
  }
  /// True if every edge of the decoded tiles has an opposite one.
  bool is_closed() const {
    using Place = std::array<std::int64_t, 3>;
    std::map<std::pair<Place, Place>, int> edges;
    for (const auto& [index, tile] : tiles_) {
      const auto place = [&](std::size_t corner) {
        const Vec3& p = tile.positions_mm[tile.indices[corner]];
        return Place{std::llround(p.x * 4096), std::llround(p.y * 4096), std::llround(p.z * 4096)};
      };
      for (std::size_t n = 0; n < tile.indices.size(); ++n) {
        const Place a = place(n), b = place(n % 3 == 2 ? n - 2 : n + 1);
        if (a < b) ++edges[{a, b}];
        if (b < a) --edges[{b, a}];
      }
    }
    return std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 0; });
  }
  const std::map<TileIndex, DecodedTile>& all() const { return tiles_; }
  std::size_t bytes() const { return bytes_; }
  /// Number of tiles received with an unchanged version: at another level, or needlessly.
  std::size_t same_version() const { return same_version_; }

 private:
  std::map<TileIndex, DecodedTile> tiles_;
  std::size_t bytes_ = 0, same_version_ = 0;
};

}  // namespace kerf::test
