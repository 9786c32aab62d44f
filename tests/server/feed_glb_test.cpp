// SPDX-License-Identifier: Apache-2.0
#include "server/feed/mesh_glb.h"
#include "tests/support/carvings.h"
#include "tests/support/glb_reader.h"
#include "tests/support/mesh_check.h"
#include "tests/support/test.h"

namespace kerf::feed_glb_test {
namespace {

const BoxStock kBlock{{-7.3, 11.1, 400.7}, {10, 30, 409.9}};

Sculpture carved_block() {
  Sculpture sculpture = test::make_sculpture(kBlock, 0.25);
  test::RandomCarver carver(sculpture, kBlock.min_mm, kBlock.max_mm, 11);
  for (int n = 0; n < 25; ++n) carver.cut();
  return sculpture;
}

std::vector<EncodedTile> encode_all(const SolidSnapshot& snapshot, TileCompression compression) {
  std::vector<EncodedTile> tiles;
  for (const TileMesh& mesh : test::mesh_all(snapshot)) {
    tiles.push_back(encode_tile(mesh, mesh_quantization(snapshot.grid()), 7, compression));
  }
  return tiles;
}

std::vector<std::byte> glb_of(const std::vector<EncodedTile>& tiles, const DexelGrid& grid) {
  std::vector<const EncodedTile*> pointers;
  for (const EncodedTile& tile : tiles) pointers.push_back(&tile);
  return write_mesh_glb(pointers, mesh_quantization(grid), 3, 12);
}

TEST(MeshQuantization, StepIsTheSmallestHalvedPitchThatFitsEveryTile) {
  for (const double pitch : {0.01, 0.1, 0.25, 3.0}) {
    for (const double height : {0.5, 50.0, 900.0}) {
      DexelGrid grid{.pitch_mm = pitch, .z_quantum_mm = std::exp2(-20)};
      grid.height_quanta = static_cast<std::int32_t>(std::min(height, 1000.0) / grid.z_quantum_mm);
      const double step = mesh_quantization(grid).step_mm;
      int exponent = 0;
      EXPECT_EQ(std::frexp(pitch / step, &exponent), 0.5);
      EXPECT_GE(step, pitch / 256);
      EXPECT_TRUE(step == pitch / 256 || std::max(height, 34 * pitch) / step > 65000 / 2);
      EXPECT_LE(height / step, 65535);
      EXPECT_LE((kTileSide + 2) * pitch / step, 65535);
    }
  }
}

class MeshGlbAccessors : public testing::TestWithParam<TileCompression> {};

TEST(MeshGlb, DecodedMeshDiffersByAtMostHalfAStep) {
  Sculpture sculpture = carved_block();
  const SolidSnapshot snapshot = sculpture.solid();
  const auto tiles = encode_all(snapshot, TileCompression::kNone);
  const auto decoded = test::read_mesh_glb(glb_of(tiles, snapshot.grid()));
  EXPECT_EQ(decoded.from, 3U);
  EXPECT_EQ(decoded.to, 12U);
  const auto meshes = test::mesh_all(snapshot);
  ASSERT_EQ(decoded.tiles.size(), meshes.size());
  const double half_step = mesh_quantization(snapshot.grid()).step_mm / 2;
  const Vec3 origin = snapshot.grid().origin_mm;
  for (const TileMesh& mesh : meshes) {
    const test::DecodedTile& tile = decoded.tiles.at(mesh.tile);
    EXPECT_EQ(tile.version, 7U);
    ASSERT_EQ(tile.positions_mm.size(), mesh.positions_mm.size());
    EXPECT_EQ(tile.indices, mesh.indices);
    EXPECT_EQ(tile.original, mesh.original);
    for (std::size_t v = 0; v < mesh.positions_mm.size(); ++v) {
      const auto& p = mesh.positions_mm[v];
      const Vec3 world = origin + Vec3{double(p[0]), double(p[1]), double(p[2])};
      const Vec3 off = tile.positions_mm[v] - world;
      EXPECT_LE(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}), half_step * 1.0001);
      const auto& n = mesh.normals[v];
      EXPECT_LT(length(tile.normals[v] - Vec3{double(n[0]), double(n[1]), double(n[2])}), 0.01);
    }
  }
}

TEST(MeshGlb, NeighboringTilesMeetExactly) {
  Sculpture sculpture = carved_block();
  const SolidSnapshot snapshot = sculpture.solid();
  const auto decoded =
      test::read_mesh_glb(glb_of(encode_all(snapshot, TileCompression::kNone), snapshot.grid()));
  // Vertices shared between tiles are equal after decoding, so the result is as watertight as the
  // mesh.
  std::map<std::array<float, 3>, Vec3> world;
  std::size_t shared = 0;
  for (const TileMesh& mesh : test::mesh_all(snapshot)) {
    const test::DecodedTile& tile = decoded.tiles.at(mesh.tile);
    for (std::size_t v = 0; v < mesh.positions_mm.size(); ++v) {
      const auto [found, is_new] = world.emplace(mesh.positions_mm[v], tile.positions_mm[v]);
      if (is_new) continue;
      ++shared;
      EXPECT_LT(length(found->second - tile.positions_mm[v]), 1e-12);
    }
  }
  EXPECT_GT(shared, 100U);
}

TEST(MeshGlb, CompressionPreservesEveryTriangle) {
  Sculpture sculpture = carved_block();
  const SolidSnapshot snapshot = sculpture.solid();
  const auto plain =
      test::read_mesh_glb(glb_of(encode_all(snapshot, TileCompression::kNone), snapshot.grid()));
  const auto packed =
      test::read_mesh_glb(glb_of(encode_all(snapshot, TileCompression::kMeshopt), snapshot.grid()));
  ASSERT_EQ(plain.tiles.size(), packed.tiles.size());
  for (const auto& [index, tile] : plain.tiles) {
    EXPECT_EQ(test::triangles_of(tile), test::triangles_of(packed.tiles.at(index)));
  }
}

TEST_P(MeshGlbAccessors, AccessorBoundsAreCorrect) {
  Sculpture sculpture = carved_block();
  const SolidSnapshot snapshot = sculpture.solid();
  const auto glb = test::split_glb(glb_of(encode_all(snapshot, GetParam()), snapshot.grid()));
  EXPECT_EQ(glb.json["extensionsRequired"][0], "KHR_mesh_quantization");
  for (const auto& accessor : glb.json["accessors"]) {
    const auto& view = glb.json["bufferViews"].at(accessor["bufferView"].get<std::size_t>());
    const auto bytes = test::view_bytes(glb, view);
    if (accessor["componentType"] != 5122) continue;
    for (std::size_t n = 0; n < accessor["count"].get<std::size_t>(); ++n) {
      const auto p = test::element<std::int16_t, 3>(bytes, 8, n);
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_GE(p[c], accessor["min"][c].get<int>());
        ASSERT_LE(p[c], accessor["max"][c].get<int>());
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, MeshGlbAccessors,
                         testing::Values(TileCompression::kNone, TileCompression::kMeshopt));

TEST(MeshGlbSize, CompressionHalvesTheSize) {
  Sculpture sculpture = carved_block();
  const SolidSnapshot snapshot = sculpture.solid();
  const auto raw = glb_of(encode_all(snapshot, TileCompression::kNone), snapshot.grid());
  const auto packed = glb_of(encode_all(snapshot, TileCompression::kMeshopt), snapshot.grid());
  EXPECT_LT(2 * packed.size(), raw.size());  // for a rough block; smooth ones compress better
}

TEST(MeshGlbTile, EmptyTileIsANodeWithoutMesh) {
  DexelGrid grid;
  EncodedTile empty{.tile = {4, 9}, .version = 2};
  const auto decoded = test::read_mesh_glb(glb_of({empty}, grid));
  EXPECT_EQ(decoded.tiles.at({4, 9}).version, 2U);
  EXPECT_TRUE(decoded.tiles.at({4, 9}).indices.empty());
  EXPECT_TRUE(test::read_mesh_glb(glb_of({}, grid)).tiles.empty());
}

TEST(MeshGlbTile, LargeTilesHaveWideIndices) {
  TileMesh mesh;
  for (int n = 0; n < 70000; ++n) {
    mesh.positions_mm.push_back({float(n % 251), float(n / 251), 0});
    mesh.normals.push_back({0, 0, 1});
    mesh.original.push_back(1);
  }
  mesh.indices = {0, 69999, 1, 2, 3, 69998};
  TileMesh small{.tile = {1, 0}, .positions_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  small.normals.assign(3, {0, 0, 1});
  small.original.assign(3, 1);
  small.indices = {0, 1, 2};
  DexelGrid grid{.pitch_mm = 10};
  const MeshQuantization quantization = mesh_quantization(grid);
  const std::vector<EncodedTile> tiles{encode_tile(small, quantization, 1),
                                       encode_tile(mesh, quantization, 1)};
  EXPECT_TRUE(tiles[1].wide_indices);
  const auto decoded = test::read_mesh_glb(glb_of(tiles, grid));
  EXPECT_EQ(decoded.tiles.at({0, 0}).indices, mesh.indices);
  EXPECT_EQ(decoded.tiles.at({1, 0}).indices, small.indices);
}

}  // namespace
}  // namespace kerf::feed_glb_test
