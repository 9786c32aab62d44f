// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"

namespace kerf {

/// An immutable picture of every field of a block: what state hashes are taken of, on any thread,
/// while the block goes on changing.
struct SolidSnapshot {
  std::vector<DexelSnapshot> fields;  ///< along Z; then along X and Y, if the block has them

  /// Of the field along Z.
  const DexelGrid& grid() const { return fields.front().grid(); }
  /// False while the tile of the field along Z is still exactly the stock's shape.
  bool touched(TileIndex tile) const { return fields.front().touched(tile); }
  /// Of one field its own hash; of three, FNV-1a over theirs.
  std::uint64_t hash() const;
};

}  // namespace kerf
