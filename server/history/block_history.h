// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <span>
#include <stop_token>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/history/group_carver.h"
#include "server/history/recorded_motions.h"
#include "server/history/tile_log.h"

namespace kerf {

/// What a history keeps for the next question.
struct HistoryMemory {
  std::size_t windows = 32;                          ///< of records (RecordedMotions)
  std::size_t tile_bytes = std::size_t{256} << 20U;  ///< of tiles that groups of motions leave
};

/// The history of a block: which motions of its journal reach which tile, and what any set of them
/// leaves of it. Since cuts commute to the bit, that is all that undo, redo, a look back and a
/// branch need. Reads the journal from its file; not thread-safe, and slow: it belongs on a thread
/// that serves nobody.
class BlockHistory {
 public:
  /// `start`: the block with these settings before its first motion.
  BlockHistory(std::filesystem::path journal, const SculptureSettings& settings,
               const SolidSnapshot& start, HistoryMemory memory = {});

  /// Reads the records that have been committed since the last call. The error is one sentence.
  std::expected<void, std::string> catch_up(const std::stop_token& stop = {});
  /// Number of the last record read.
  std::uint64_t last() const { return motions_.strokes().last(); }
  const StrokeTable& strokes() const { return motions_.strokes(); }

  /// Returns the tiles that these strokes may have changed; sorted. Strokes that do not exist have
  /// none.
  std::expected<std::vector<FieldTile>, std::string> reach(const StrokeSet& strokes,
                                                           const std::stop_token& stop = {});
  /// Returns all tiles that any motion reaches; sorted.
  std::vector<FieldTile> tiles() const;
  /// Returns what a set of motions leaves of these tiles, which are sorted, without duplicates. The
  /// set holds records that have been read only.
  std::expected<std::vector<TileReplacement>, std::string> carve(std::span<const FieldTile> tiles,
                                                                 const MotionSet& set,
                                                                 Workers& workers,
                                                                 const std::stop_token& stop = {});

  /// Bytes of the lists of motions of all tiles.
  std::size_t log_bytes() const;
  /// Bytes of the tiles that are kept.
  std::size_t tile_bytes() const;

 private:
  struct Wanted;
  struct TileHash {
    std::size_t operator()(const FieldTile& at) const {
      constexpr std::uint64_t kSpread = 0x9e3779b97f4a7c15;
      const auto x = static_cast<std::uint32_t>(at.tile.x);
      const auto y = static_cast<std::uint32_t>(at.tile.y);
      return ((std::uint64_t{x} << 32U | y) ^ static_cast<std::uint64_t>(at.axis) << 62U) *
                 kSpread >>
             20U;
    }
  };
  void note(std::uint64_t record, const RecordedMotion& motion);
  void add_wanted(FieldTile at, TileLog& log, const MotionSet& set, std::vector<Wanted>& wanted,
                  std::vector<GroupJob>& jobs);
  void forget_oldest();

  RecordedMotions motions_;
  GroupCarver carver_;
  std::vector<DexelGrid> grids_;
  double tolerance_mm_;
  std::unordered_map<FieldTile, TileLog, TileHash> logs_;
  std::vector<FieldTile> reached_;  ///< by one motion; reuses its memory
  std::uint64_t questions_ = 0;     ///< asked so far
  std::size_t tile_bytes_max_;
};

}  // namespace kerf
