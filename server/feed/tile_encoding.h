// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// The lattice of the positions of all tiles of a block. They share it, so neighboring tiles meet
/// exactly.
struct MeshQuantization {
  Vec3 origin_mm;              ///< DexelGrid::origin_mm
  double step_mm = 1;          ///< the pitch, halved up to 8 times while a tile fits 65536 steps
  double tile_mm = kTileSide;  ///< side of a tile
};
MeshQuantization mesh_quantization(const DexelGrid& grid);

enum class TileCompression : std::uint8_t {
  kNone,
  kMeshopt
};  ///< kMeshopt: EXT_meshopt_compression

/// An encoded tile, which can be copied into any number of frames.
struct EncodedTile {
  /// Bytes per vertex before compression: int16 x, y, z, padding; int8 x, y, z of the normal, and
  /// TileMesh::original.
  static constexpr std::size_t kPositionStride = 8, kNormalStride = 4;

  TileIndex tile;
  std::uint32_t version = 0;
  std::uint8_t level = 0;  ///< of detail; 0: exact
  TileCompression compression = TileCompression::kNone;
  std::uint32_t vertices = 0, indices = 0;                 ///< both 0: the tile is empty
  bool wide_indices = false;                               ///< 32-bit instead of 16-bit
  std::array<double, 3> translation_mm{};                  ///< world position of step 0
  std::array<std::int16_t, 3> min{}, max{};                ///< of the positions, in steps
  std::vector<std::byte> positions, normals, index_bytes;  ///< as in the GLB, unpadded
  std::uint64_t shape_hash = 0;                            ///< equal for tiles of the same shape
  std::uint64_t digest = 0;  ///< of its columns (column_digest.h), set by the feed

  std::size_t index_stride() const { return wide_indices ? 4 : 2; }
  std::size_t bytes() const { return positions.size() + normals.size() + index_bytes.size(); }
  /// Whether the meshes of two tiles differ only in position, like those of untouched tiles inside
  /// a block.
  bool has_shape_of(const EncodedTile& other) const;
};

/// Quantizes a tile to int16 positions and int8 normals, with errors of at most half a step and 0.4
/// degrees, and compresses them if requested. Compression preserves all vertices and triangles but
/// reorders them. Every vertex of `mesh` must be used by a triangle.
EncodedTile encode_tile(const TileMesh& mesh, const MeshQuantization& quantization,
                        std::uint32_t version,
                        TileCompression compression = TileCompression::kNone);

}  // namespace kerf
