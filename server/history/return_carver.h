// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <memory>
#include <mutex>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "kernel/cut/workers.h"
#include "kernel/tile_carver.h"
#include "server/history/motion_spans.h"
#include "server/history/recorded_motions.h"

namespace kerf {

/// Stock of one tile that may come back, and the motions that may still remove part of it.
struct ReturnJob {
  FieldTile at;
  std::shared_ptr<const DexelTile> stock;     ///< in: candidates; out: stock that returns, or null
  std::vector<const MotionSpan*> spans = {};  ///< that meet it
  std::size_t next = 0;                       ///< in spans
};

/// Carves the stock that comes back when strokes are undone. It is little, and most motions miss
/// it, so the deepest motions are cut first: after a few of them, most others meet nothing and are
/// not even read.
class ReturnCarver {
 public:
  /// `start`: the block with these settings before its first motion.
  ReturnCarver(SculptureSettings settings, SolidSnapshot start);

  /// Executes the jobs, each for another tile, with the motions up to record `last`.
  std::expected<void, std::string> carve(std::span<ReturnJob> jobs, std::uint64_t last,
                                         RecordedMotions& motions, Workers& workers,
                                         const std::stop_token& stop);

 private:
  /// The cuts of a job before the next windows are read.
  struct Turn {
    ReturnJob* job;
    std::size_t end;  ///< in its spans
  };
  std::vector<Turn> next_turns(std::span<ReturnJob> jobs, std::vector<std::uint64_t>& firsts) const;
  void work(const Turn& turn, std::uint64_t last, const RecordedMotions::Windows& windows);
  std::unique_ptr<TileCarver> take_carver();
  std::vector<Bounds> boxes_of(const DexelTile& tile, FieldTile at) const;

  SculptureSettings settings_;
  SolidSnapshot start_;
  double margin_mm_ = 0;  ///< greatest distance of ends from the sweep of a motion
  std::mutex mutex_;      ///< guards carvers_
  std::vector<std::unique_ptr<TileCarver>> carvers_;  ///< not used by a thread
};

}  // namespace kerf
