// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/sculpture_result.h"

namespace kerf {

/// Visits the columns along Z that a motion has changed, one row of a tile after the other, so that
/// a long search can be divided into portions. Most rows of a cut tile are unchanged, and most
/// columns of the changed rows.
class ChangedRows {
 public:
  using Visit = std::function<void(std::int32_t i, std::int32_t j)>;

  /// `cut` are the tiles that lost material (repeats allowed, other fields are ignored).
  ChangedRows(DexelSnapshot before, DexelSnapshot after, const std::vector<FieldTile>& cut);

  const DexelSnapshot& before() const { return before_; }
  const DexelSnapshot& after() const { return after_; }
  /// Returns the number of rows visited so far.
  std::size_t visited() const { return next_; }
  bool is_done() const { return next_ == tiles_.size() * kTileSide; }
  /// Visits the changed columns of the next row. There must be one.
  void visit_next(const Visit& visit);

 private:
  DexelSnapshot before_, after_;
  std::vector<TileIndex> tiles_;
  std::size_t next_ = 0;  ///< of all rows of all tiles
};

}  // namespace kerf
