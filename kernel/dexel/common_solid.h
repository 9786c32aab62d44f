// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

struct DexelTile;

/// Intersects the columns of `tile` with those of `other`, a tile of another copy of the block at
/// the same place, with normals if `tile` has them. Each end keeps the normal of the tile that it
/// comes from; where both have an end at the same depth, that of `tile`.
void keep_common(DexelTile& tile, const DexelTile& other);

}  // namespace kerf
