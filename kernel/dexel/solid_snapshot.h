// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"

namespace kerf {

/// An immutable view of all fields of a block, for meshing and state hashes on any thread while the
/// block changes.
struct SolidSnapshot {
  std::vector<DexelSnapshot> fields;  ///< along Z; then along X and Y for Rays::kTriDexel

  /// Returns the grid of the field along Z.
  const DexelGrid& grid() const { return fields.front().grid(); }
  /// Returns whether a tile of the field along Z is stored. An untouched tile has the stock's
  /// shape.
  bool touched(TileIndex tile) const { return fields.front().touched(tile); }
  /// Returns the hash of the only field, or FNV-1a over the hashes of the three.
  std::uint64_t hash() const;
};

}  // namespace kerf
