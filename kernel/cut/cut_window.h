// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kernel/cut/removal.h"
#include "kernel/cut/tile_cutter.h"
#include "kernel/cut/workers.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// A window of sweeps that are cut together, tile by tile. Each tile is cut by all sweeps that may
/// reach it, in their order, so removed and remaining elements are equal, to the bit, to those of
/// cutting one sweep after the other. The tiles are divided among workers.
class CutWindow {
 public:
  /// A sweep and a tile that it may change. Touches are numbered sweep by sweep, and row by row
  /// within a sweep.
  struct Touch {
    std::size_t sweep;
    TileIndex tile;
  };
  /// Called on any thread with the number of a touch that has removed material, and the removed
  /// elements, which it may change.
  using Visit = std::function<void(std::size_t touch, RemovedPart& removed)>;

  /// Once a window has this many touches, no tile is added. Their sums take 3 MB, and as much again
  /// for those that one step of the search adds.
  static constexpr std::size_t kTouchesMax = 4096;

  /// Adds a sweep of a field of the block, which must stay in place until cut(). Adds its tiles
  /// from number `first` on, counted in the rectangle that bounds the sweep, until the window is
  /// full. Returns the number of the tile at which the next window continues, or 0 if all have been
  /// added. `end_code` comes from LazyNormals::add_sweep.
  std::int64_t add(DexelField& field, const SweptTool& swept, NormalCode end_code,
                   std::int64_t first);
  bool is_full() const { return touches_.size() >= kTouchesMax; }
  std::span<const Touch> touches() const { return touches_; }
  /// Cuts all sweeps. A small amount of work is done on the calling thread alone.
  void cut(Workers& workers, const Visit& visit);
  /// Removes the sweeps.
  void clear();

 private:
  struct Sweep {
    DexelField* field;
    const SweptTool* swept;
    NormalCode end_code;
    double work;  ///< per tile
  };
  struct Job {
    TileCutter cutter;
    RemovedPart removed;
  };
  void sort_by_tile();
  void run(Job& job, std::span<const std::size_t> touches, const Visit& visit);
  std::vector<std::span<const std::size_t>> divide(std::size_t jobs) const;
  bool same_tile(std::size_t a, std::size_t b) const;

  std::vector<Sweep> sweeps_;
  std::vector<Touch> touches_;
  std::vector<TileIndex> tiles_;      ///< of one sweep
  std::vector<std::size_t> by_tile_;  ///< touches, sorted by tile
  double work_ = 0;                   ///< of all touches
  std::vector<Job> jobs_;             ///< kept to reuse their memory
};

}  // namespace kerf
