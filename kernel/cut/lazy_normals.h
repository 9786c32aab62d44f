// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/cut/removal.h"
#include "kernel/cut/workers.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/sweep/swept_surface.h"

namespace kerf {

/// Surface normals of dexel ends, computed lazily. A moving tool cuts the same column dozens of
/// times, and only the last end remains. So each new end first stores the number of the sweep that
/// made it in place of its normal, and resolve() replaces the numbers of the ends that still exist
/// by normals. While a batch of sweeps is collected, the tiles of the batch before it are resolved
/// in small steps, so that no motion waits for all of them. The result does not depend on when that
/// happens.
///
/// Ends that a sweep does not move keep their normals. If two motions leave an end at the same
/// depth, the normal of the first is kept. So normals depend on the order of the commands, and the
/// state hash excludes them.
class LazyNormals {
 public:
  /// Registers a part of a tool's motion that is about to cut the field, in the field's frame.
  /// Returns the code that marks the ends that it makes (mark_ends), or kStockNormal, without
  /// registering anything, if the field keeps no normals. Begins a batch first if is_full().
  NormalCode add_sweep(DexelField& field, const Tool& tool, const ToolMotion& part);
  /// Returns whether the batch has the maximum number of sweeps.
  bool is_full() const { return now_.sweeps.size() == kSweepsMax; }
  /// Begins a batch. All earlier sweeps must have cut, and the tiles that they changed must be
  /// registered.
  void begin_batch(DexelField& field, Workers& workers);
  /// Registers a tile that a sweep changed.
  void add_tile(TileIndex tile) {
    if (!now_.sweeps.empty()) now_.tiles.push_back(tile);
  }
  /// Resolves as large a share of the previous batch as the present one is full.
  void resolve_some(DexelField& field, Workers& workers);
  /// Computes all pending normals. Must run before the field's normals are read, and before a
  /// snapshot is taken, because it edits tiles in place. The tiles are divided among the workers.
  void resolve(DexelField& field, Workers& workers);
  void resolve(DexelField& field) {
    SerialWorkers alone;
    resolve(field, alone);
  }
  /// Returns the bytes of its buffers, without those of the sweeps' tools.
  std::size_t bytes() const;

 private:
  /// Few enough that a snapshot does not delay a haptic tick noticeably, many enough that most
  /// marked ends have been cut away by then.
  static constexpr std::size_t kSweepsMax = 256;
  /// An end that still exists, and the sweep that made it.
  struct End {
    NormalCode* code;
    double x_mm, y_mm, z_mm;
    std::uint32_t group;  ///< twice the number of the sweep in its batch, plus 1 for a lower end
  };
  /// The ends of some tiles. Reuses its memory.
  struct Job {
    std::vector<End> ends = {};
    std::vector<std::uint32_t> by_group = {};     ///< numbers of ends, sorted by group
    std::vector<std::uint32_t> group_begin = {};  ///< in by_group, and the end of the last group
    std::size_t bytes() const;
  };
  struct Batch {
    NormalCode first_code = 1;  ///< of its first sweep
    std::vector<SweptSurface> sweeps = {};
    std::vector<TileIndex> tiles = {};  ///< that it changed
    std::size_t resolved = 0;           ///< of the tiles
    bool has(NormalCode code) const { return code - first_code < sweeps.size(); }
  };

  /// Adds a tile's ends to the job.
  static void collect(DexelTile& tile, TileIndex at, const DexelGrid& grid, const Batch& batch,
                      Job& job);
  /// Computes the normals of the ends in the job, and empties it.
  static void resolve_collected(const Batch& batch, Job& job);
  static void resolve_tiles(DexelField& field, const Batch& batch, std::span<const TileIndex> tiles,
                            Job& job);
  void resolve_until(DexelField& field, Workers& workers, Batch& batch, std::size_t end);
  void finish(DexelField& field, Workers& workers, Batch& batch);

  Batch now_, before_{.first_code = 1 + kSweepsMax};  ///< the tiles of before_ are sorted
  std::vector<Job> jobs_;
};

/// Marks, in a tile that keeps normals, the ends that a sweep has just made. `removed` has the
/// elements that the sweep removed from this tile.
void mark_ends(DexelTile& tile, std::span<const RemovedGroup> removed, NormalCode code);

}  // namespace kerf
