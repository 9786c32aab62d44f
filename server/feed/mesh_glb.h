// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/feed/tile_encoding.h"

namespace kerf {

/// Content of a node of a frame: a tile, or a rectangle of equal ones (extras.repeat); with
/// kVerified also of equal digests, which it states (extras.digest).
enum class TileNodes : std::uint8_t { kSingle, kRepeated, kVerified };

/// Writes a self-contained GLB with one node per tile (or several tiles, unless kSingle), as
/// specified in server/wire/README.md: node `t_X_Y` with extras {tile, version, level if coarse,
/// digest with kVerified}; translation and scale give world coordinates (mm, Z up, as everywhere on
/// the wire; downloads use glTF's meters and Y up); KHR_mesh_quantization, and
/// EXT_meshopt_compression for compressed tiles; scene.extras {from, to}. Tiles of the same shape
/// share one mesh.
std::vector<std::byte> write_mesh_glb(std::span<const EncodedTile* const> tiles,
                                      const MeshQuantization& quantization, std::uint64_t from,
                                      std::uint64_t to, TileNodes nodes = TileNodes::kSingle);

}  // namespace kerf
