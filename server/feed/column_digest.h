// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/dexel/solid_snapshot.h"

namespace kerf {

/// Hashes the state of a tile of the field along Z, which must be in the grid: where the rays of
/// its columns are solid and, in a block with three fields, where rays along X and Y begin and end
/// inside it. Not its place and not its normals, so that equal tiles of a block have equal digests,
/// and tiles of a replay those of the block. O(its columns).
std::uint64_t column_digest(const SolidSnapshot& solid, TileIndex tile);

}  // namespace kerf
