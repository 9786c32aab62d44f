// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// The one lattice on which all tiles of a block are sent, so that neighbours meet exactly.
struct MeshQuantization {
  Vec3 origin_mm;      ///< DexelGrid::origin_mm
  double step_mm = 1;  ///< the pitch, halved up to 8 times as long as a tile fits 65536 steps
};
MeshQuantization mesh_quantization(const DexelGrid& grid);

enum class TileCompression : std::uint8_t {
  kNone,
  kMeshopt
};  ///< kMeshopt: EXT_meshopt_compression

/// One tile, ready to be put into any number of frames.
struct EncodedTile {
  /// Bytes per vertex before compression: int16 x, y, z, padding; int8 x, y, z, padding.
  static constexpr std::size_t kPositionStride = 8, kNormalStride = 4;

  TileIndex tile;
  std::uint32_t version = 0;
  std::uint8_t level = 0;  ///< of detail; 0: exact
  TileCompression compression = TileCompression::kNone;
  std::uint32_t vertices = 0, indices = 0;                 ///< both 0: nothing is left of the tile
  bool wide_indices = false;                               ///< 32-bit instead of 16-bit
  std::array<double, 3> translation_mm{};                  ///< where step 0 lies, in the world
  std::array<std::int16_t, 3> min{}, max{};                ///< of the positions, steps
  std::vector<std::byte> positions, normals, index_bytes;  ///< as they stand in the GLB, unpadded

  std::size_t index_stride() const { return wide_indices ? 4 : 2; }
  std::size_t bytes() const { return positions.size() + normals.size() + index_bytes.size(); }
};

/// Quantises a tile to int16 positions and int8 normals (at most half a step and 0.4 degrees off),
/// and compresses them if asked to. Compression keeps every vertex and triangle, but in another
/// order. A mesh holds no vertex that it does not use.
EncodedTile encode_tile(const TileMesh& mesh, const MeshQuantization& quantization,
                        std::uint32_t version,
                        TileCompression compression = TileCompression::kNone);

}  // namespace kerf
