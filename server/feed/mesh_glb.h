// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/feed/tile_encoding.h"

namespace kerf {

/// One self-contained GLB with a node per tile, as server/wire/README.md says: node `t_X_Y`, extras
/// {tile, version, level if coarse}, translation and scale into the world (mm, Z up, as everything
/// on the wire; downloads convert to glTF's metres and Y up), KHR_mesh_quantization,
/// EXT_meshopt_compression where tiles are compressed; scene.extras {from, to}.
std::vector<std::byte> write_mesh_glb(std::span<const EncodedTile* const> tiles,
                                      const MeshQuantization& quantization, std::uint64_t from,
                                      std::uint64_t to);

}  // namespace kerf
