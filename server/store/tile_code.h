// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "kernel/dexel/dexel_tile.h"
#include "server/store/byte_code.h"

namespace kerf {

/// Appends the columns of a tile, with their normal codes if it keeps them, as bytes that compress
/// well (README.md, "Snapshots"). No normal may be pending (LazyNormals).
void encode_tile(const DexelTile& tile, std::vector<std::byte>& out);

/// Reads a tile that encode_tile has written; null if the bytes are not one, or one of a field that
/// is less high or differs in keeping normals.
std::shared_ptr<DexelTile> decode_tile(ByteReader& in, std::int32_t height_quanta,
                                       bool keeps_normals);

}  // namespace kerf
