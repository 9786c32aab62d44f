// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "kernel/cut/workers.h"
#include "kernel/tile_carver.h"
#include "server/history/motion_spans.h"
#include "server/history/recorded_motions.h"

namespace kerf {

/// A job: the motions of some runs, up to a record, cut from one tile. The result is null if they
/// do not reach it.
struct GroupJob {
  FieldTile at;
  std::uint64_t last = 0;                           ///< record; runs may end later
  std::vector<MotionRun> runs = {};                 ///< of the strokes that are not excluded
  std::shared_ptr<const DexelTile> from = nullptr;  ///< null: the tile before the first motion
  std::shared_ptr<const DexelTile> tile = nullptr;  ///< the result
};

/// Carves groups of motions. Reads each record once, however many tiles its motion reaches, and
/// divides the tiles among workers. Results do not depend on the workers.
class GroupCarver {
 public:
  /// `start`: the block with these settings before its first motion.
  GroupCarver(SculptureSettings settings, SolidSnapshot start);

  /// Executes the jobs, which are in the order of their tiles and, for one tile, of their records,
  /// which no two share. After an error, results that are not null are valid.
  std::expected<void, std::string> carve(std::span<GroupJob> jobs, RecordedMotions& motions,
                                         Workers& workers, const std::stop_token& stop);
  /// Returns a tile before the first motion; null: untouched stock.
  std::shared_ptr<const DexelTile> start(FieldTile at) const { return carvers_.front().start(at); }
  /// Returns a copy of it, also for untouched stock.
  std::shared_ptr<DexelTile> copy_of_start(FieldTile at) const {
    return carvers_.front().copy_of_start(at);
  }

 private:
  SculptureSettings settings_;
  SolidSnapshot start_;
  std::vector<TileCarver> carvers_;  ///< one for each part of the work
};

}  // namespace kerf
