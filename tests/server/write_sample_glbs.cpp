// SPDX-License-Identifier: Apache-2.0
// Writes one GLB of every kind that Kerf produces into a folder, for gltf-validator: the download
// of a carved block; mesh frames with many tiles of which one is empty, with an empty tile only,
// and without tiles. Usage: write_sample_glbs FOLDER

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "server/feed/mesh_glb.h"
#include "server/formats/model/model_writer.h"
#include "tests/support/carvings.h"
#include "tests/support/mesh_check.h"

namespace {

using namespace kerf;

/// A mesh source with a color and a deviation for every vertex.
class ColoredMesh final : public MeshSource {
 public:
  explicit ColoredMesh(SnapshotMesh mesh) : mesh_(std::move(mesh)) {}
  Vec3 origin_mm() const override { return mesh_.origin_mm(); }
  Vec3 size_mm() const override { return mesh_.size_mm(); }
  double share() const override { return mesh_.share(); }
  bool next(MeshPiece& piece) override {
    if (!mesh_.next(piece)) return false;
    piece.colors.assign(piece.positions_mm.size(), {20, 120, 220});
    piece.deviations_mm.assign(piece.positions_mm.size(), -0.25F);
    return true;
  }

 private:
  SnapshotMesh mesh_;
};

bool write(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) std::fprintf(stderr, "%s: cannot write\n", path.c_str());
  return bool(file);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write_sample_glbs FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  const BoxStock block{{-20, 10, 5}, {17, 40, 19}};
  Sculpture sculpture = test::make_sculpture(block, 0.25);
  test::RandomCarver carver(sculpture, block.min_mm, block.max_mm, 1);
  for (int n = 0; n < 60; ++n) carver.cut();
  const SolidSnapshot snapshot = sculpture.solid();
  const MeshQuantization quantization = mesh_quantization(snapshot.grid());
  std::vector<EncodedTile> tiles;
  for (const TileMesh& mesh : test::mesh_all(snapshot)) {
    tiles.push_back(encode_tile(mesh, quantization, 3, TileCompression::kMeshopt));
  }
  EncodedTile gone{.tile = {90, 91}, .version = 4};
  std::vector<const EncodedTile*> all;
  for (const EncodedTile& tile : tiles) all.push_back(&tile);
  const EncodedTile plain = encode_tile(mesh_tile(snapshot, {0, 0}), quantization, 3);
  const std::vector<const EncodedTile*> raw{&plain, &gone};
  const std::vector<const EncodedTile*> mixed{&tiles[1], &gone, &plain, &tiles[2]};
  const std::vector<const EncodedTile*> only_gone{&gone};
  bool ok = true;
  for (const ModelEncoding encoding : model_encodings(ModelFormat::kGlb)) {
    const ModelRequest request{
        .format = ModelFormat::kGlb, .encoding = encoding, .title = "sample \"block\""};
    SnapshotMesh mesh(snapshot);
    ColoredMesh colored{SnapshotMesh(snapshot)};
    const std::string name = std::string(to_string(encoding)) + ".glb";
    ok = ok && write_model(folder / ("model_" + name), mesh, request) &&
         write_model(folder / ("colored_" + name), colored, request);
  }
  ok = ok && write(folder / "frame_all.glb", write_mesh_glb(all, quantization, 0, 60)) &&
       write(folder / "frame_raw.glb", write_mesh_glb(raw, quantization, 0, 60)) &&
       write(folder / "frame_mixed.glb", write_mesh_glb(mixed, quantization, 59, 60)) &&
       write(folder / "frame_verified.glb",
             write_mesh_glb(all, quantization, 0, 60, TileNodes::kVerified)) &&
       write(folder / "frame_gone.glb", write_mesh_glb(only_gone, quantization, 1, 2)) &&
       write(folder / "frame_empty.glb", write_mesh_glb({}, quantization, 1, 2));
  return ok ? 0 : 1;
}
