// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/sculpture_result.h"

namespace kerf {

/// Visits the columns along Z that a motion has changed, one row of a tile after the other, in
/// portions. Most rows of a cut tile are unchanged, and most columns of the changed rows.
class ChangedRows {
 public:
  /// Measures a changed column. Returns the number of distances it has computed.
  using Measure = std::function<std::size_t(std::int32_t i, std::int32_t j)>;

  /// `cut` are the tiles that lost material (repeats allowed, other fields are ignored).
  ChangedRows(DexelSnapshot before, DexelSnapshot after, const std::vector<FieldTile>& cut);

  const DexelSnapshot& before() const { return before_; }
  const DexelSnapshot& after() const { return after_; }
  /// Measures the changed columns of the next rows until about so many distances have been
  /// computed. The comparison of a row counts as a small part of a distance. Returns true when all
  /// rows have been visited.
  bool advance(std::size_t distances, const Measure& measure);

 private:
  std::size_t measure_next(const Measure& measure);

  DexelSnapshot before_, after_;
  std::vector<TileIndex> tiles_;
  std::size_t next_ = 0;  ///< of all rows of all tiles
};

}  // namespace kerf
