// SPDX-License-Identifier: Apache-2.0
#pragma once

// Motions that a Sculpture applies together; not part of its public interface.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "kernel/cut/changed_tiles.h"
#include "kernel/cut/cut_window.h"
#include "kernel/force/cut_sum.h"
#include "kernel/force/engagement.h"
#include "kernel/force/surface_weight.h"
#include "kernel/sculpture.h"
#include "kernel/sculpture_motion.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

class CuttingForce;

/// Applies motions to a Sculpture so that several threads can work on short ones: their sweeps are
/// found in order, cut together (CutWindow), and summed in order. State and results are equal, to
/// the bit, to those of applying the motions one by one. Only memory is kept between calls.
class MotionWindow {
 public:
  MotionWindow();
  ~MotionWindow();
  /// The motions must pass Sculpture::check.
  std::vector<MotionResult> apply(Sculpture& block, std::span<const MoveTool> moves,
                                  Workers& workers, const Sculpture::AfterMotion& after);

 private:
  struct Motion;
  struct Cut;
  struct Outcome;
  /// Sums over the elements that a sub-motion removed from a field, for the force.
  struct Felt {
    TileSum sums;
    std::int64_t quanta = 0;
  };

  bool waits(const Tool& tool, const ToolMotion& motion) const;
  void plan(const MoveTool& move, MotionResult& result);
  void plan_field(Motion& motion, std::size_t field);
  void plan_part(Motion& motion, std::size_t field, SubMotion&& part, bool is_first);
  void flush();
  void drop();
  void cut_all();
  void measure(std::size_t touch, RemovedPart& removed);
  void deliver(Cut& cut, std::size_t first, std::size_t end);
  CuttingForce& force_of(Motion& motion);
  void finish_motions(const Motion* until);
  void finish(Motion& motion);

  Sculpture* block_ = nullptr;  ///< this and the next two belong to the call in progress
  Workers* workers_ = nullptr;
  const Sculpture::AfterMotion* after_ = nullptr;
  std::size_t finished_ = 0;    ///< motions
  std::deque<Motion> motions_;  ///< not finished yet
  std::vector<std::unique_ptr<Cut>> cuts_;
  std::size_t cuts_used_ = 0;
  CutWindow window_;
  std::vector<Outcome> outcomes_;  ///< of each touch
  std::vector<TileSum> sums_;      ///< of each touch, if any motion is felt
  Felt felt_;                      ///< of a sub-motion with tiles that are still to be cut
  std::vector<Bounds> reads_;      ///< where unfinished motions will read the stock
};

}  // namespace kerf
