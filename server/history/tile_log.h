// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/history/stroke_table.h"

namespace kerf {

struct DexelTile;

/// Motions of one stroke that reach a tile: those among the records first … last. Motions in
/// between that do not reach it may be among them.
struct MotionRun {
  StrokeId stroke = 0;
  std::uint64_t first = 0, last = 0;
  friend bool operator==(const MotionRun&, const MotionRun&) = default;
};

/// Consecutive motions that reach a tile, and what they leave of it.
struct MotionGroup {
  std::uint64_t first = 0, last = 0;  ///< records
  std::uint64_t motions = 0;          ///< that reach the tile
  std::vector<std::byte> runs;        ///< coded; of a group that is not closed, not all of them

  // What its motions, without some strokes, leave of the tile; null: all of it.
  bool is_carved = false;
  std::shared_ptr<const DexelTile> tile = nullptr;
  std::vector<StrokeId> without = {};  ///< those of its strokes that were left out; ascending
  std::uint64_t used = 0;              ///< when it was last asked for
};

/// The motions that reach one tile, in groups. Groups grow with their number, so that a tile has at
/// most kGroupsMax of them, however many motions reach it.
class TileLog {
 public:
  static constexpr std::size_t kGroupsMax = 128;
  static constexpr std::uint64_t kMotionsOfGroup = 512;  ///< at first
  /// Records of others, or of motions that do not reach the tile, that a run may hold in between.
  static constexpr std::uint64_t kGap = 64;

  /// Adds a motion; records ascend.
  void add(std::uint64_t record, StrokeId stroke);
  std::vector<MotionGroup>& groups() { return groups_; }
  const std::vector<MotionGroup>& groups() const { return groups_; }
  /// Returns the runs of a group, given its place.
  std::vector<MotionRun> runs(std::size_t group) const;
  /// Returns the bytes of the log, without what groups leave of the tile.
  std::size_t bytes() const;

 private:
  void close_run(const MotionRun& run);
  void close_group();
  void join_groups();

  std::vector<MotionGroup> groups_;
  std::vector<MotionRun> open_;  ///< of the last group: they may still grow
  MotionRun last_closed_;        ///< of the last group; the next one is coded as a difference
  std::uint64_t motions_of_group_ = kMotionsOfGroup;
  bool is_open_ = false;  ///< the last group
};

}  // namespace kerf
