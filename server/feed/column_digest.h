// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/dexel/solid_snapshot.h"

namespace kerf {

/// Hashes the state of a tile of the field along Z, which must be in the grid: the solid intervals
/// of its columns and, in a block with three fields, the ends of rays along X and Y inside it.
/// Position and normals are excluded, so equal tiles of a block have equal digests, and tiles of a
/// replay those of the block. O(its columns).
std::uint64_t column_digest(const SolidSnapshot& solid, TileIndex tile);

}  // namespace kerf
