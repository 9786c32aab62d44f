// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "kernel/dexel/dexel_tile.h"
#include "server/store/byte_code.h"

namespace kerf {

/// Appends the columns of a tile, and its normal codes if it keeps them, as bytes that compress
/// well (README.md, "Snapshots"). No normal may be pending (LazyNormals).
void encode_tile(const DexelTile& tile, std::vector<std::byte>& out);

/// Reads the output of encode_tile. Null if the bytes are malformed, or if the tile exceeds the
/// field's height or differs in keeping normals.
std::shared_ptr<DexelTile> decode_tile(ByteReader& in, std::int32_t height_quanta,
                                       bool keeps_normals);

}  // namespace kerf
