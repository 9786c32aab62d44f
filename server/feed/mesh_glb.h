#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// The one lattice on which all tiles of a block are sent, so that neighbours meet exactly.
struct MeshQuantization {
  Vec3 origin_mm;      ///< DexelGrid::origin_mm
  double step_mm = 1;  ///< a power of two; any tile of the block fits 65536 steps
};
MeshQuantization mesh_quantization(const DexelGrid& grid);

/// One tile, ready to be put into any number of frames.
struct EncodedTile {
  TileIndex tile;
  std::uint32_t version = 0;
  std::uint32_t vertices = 0, indices = 0;   ///< both 0: nothing is left of the tile
  bool wide_indices = false;                 ///< 32-bit instead of 16-bit
  std::array<double, 3> translation_mm{};    ///< where step 0 lies, in the world
  std::array<std::int16_t, 3> min{}, max{};  ///< of the positions, steps
  std::array<std::int8_t, 3> normal_min{}, normal_max{};
  std::vector<std::byte> positions;    ///< int16 x, y, z, padding: 8 bytes per vertex
  std::vector<std::byte> normals;      ///< int8 x, y, z, padding: 4 bytes per vertex
  std::vector<std::byte> index_bytes;  ///< padded to 4 bytes
  std::size_t bytes() const { return positions.size() + normals.size() + index_bytes.size(); }
  /// The same surface, whatever the version.
  bool same_surface(const EncodedTile& other) const;
};
EncodedTile encode_tile(const TileMesh& mesh, const MeshQuantization& quantization,
                        std::uint32_t version);

/// One self-contained GLB with a node per tile, as server/wire/README.md says: node `t_X_Y`, extras
/// {tile, version}, translation and scale into the world (mm, Z up, as everything on the wire;
/// downloads convert to glTF's metres and Y up), KHR_mesh_quantization; scene.extras {from, to}.
std::vector<std::byte> write_mesh_glb(std::span<const EncodedTile* const> tiles,
                                      const MeshQuantization& quantization, std::uint64_t from,
                                      std::uint64_t to);

}  // namespace kerf
