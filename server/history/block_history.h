// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "server/history/era_tiles.h"
#include "server/history/group_carver.h"
#include "server/history/motion_spans.h"
#include "server/history/recorded_motions.h"
#include "server/history/return_carver.h"
#include "server/history/surface_maker.h"

namespace kerf {

/// Tiles to carve together when a whole block is replaced, to bound the memory to some 10 MB.
inline constexpr std::size_t kTilesAtOnce = 128;

/// Memory that a history keeps between queries.
struct HistoryMemory {
  std::size_t windows = 128;                         ///< of records (RecordedMotions)
  std::size_t tile_bytes = std::size_t{256} << 20U;  ///< of tiles (EraTiles)
};

/// The history of a block: which motions of its journal reach which tile, and the stock that any
/// set of them leaves. Since cuts commute to the bit, undo, redo, a look back and a branch need
/// nothing else. Not thread-safe, and slow: use it on a background thread. An exception, for lack
/// of memory say, may leave a record half read or a tile half carved: discard the history then.
class BlockHistory {
 public:
  /// `start`: the block with these settings before its first motion.
  BlockHistory(std::unique_ptr<RecordSource> journal, const SculptureSettings& settings,
               const SolidSnapshot& start, HistoryMemory memory = {});

  /// Reads the records added since the last call. The error is one sentence.
  std::expected<void, std::string> catch_up(const std::stop_token& stop = {});
  /// Number of the last record read.
  std::uint64_t last() const { return motions_.strokes().last(); }
  const StrokeTable& strokes() const { return motions_.strokes(); }
  /// The newest definition of each tool in the records read.
  std::map<ToolId, Tool> tools() const { return motions_.tools(); }

  /// Returns the tiles that these strokes may have changed; sorted. Unknown strokes are ignored.
  std::expected<std::vector<FieldTile>, std::string> reach(const StrokeSet& strokes,
                                                           const std::stop_token& stop = {});
  /// Returns all tiles that a motion may have reached; sorted.
  std::vector<FieldTile> tiles() const;
  /// Returns these tiles, which are sorted and without duplicates, after a set of motions. The set
  /// has only records that have been read.
  std::expected<std::vector<TileReplacement>, std::string> carve(std::span<const FieldTile> tiles,
                                                                 const MotionSet& set,
                                                                 Workers& workers,
                                                                 const std::stop_token& stop = {});

  /// Returns the tiles among `reached` that differ after the strokes `changed` are undone or
  /// redone, as the motions of `set` leave them. `solid`: the block after the set, with or without
  /// any of these strokes. `reached`: sorted, without duplicates. Outside reach() of these strokes
  /// nothing changes. The cost depends on the surroundings of these strokes, not on the length of
  /// the history.
  std::expected<std::vector<TileReplacement>, std::string> change(
      const SolidSnapshot& solid, std::span<const FieldTile> reached, const StrokeSet& changed,
      const MotionSet& set, Workers& workers, const std::stop_token& stop = {});

  /// Returns the first motion of a set that removed a quantum of stock, or nullopt if none did, or
  /// it never was stock.
  std::expected<std::optional<SurfaceMaker>, std::string> first_to_remove(
      const StockCell& cell, const MotionSet& set, const std::stop_token& stop = {});

  /// Returns the participant whose motion of a set was the first to remove each of these quanta, or
  /// 0 if none did, it never was stock, or a journal of version 1 does not say.
  std::expected<std::vector<ParticipantId>, std::string> owners(std::span<const StockCell> cells,
                                                                const MotionSet& set,
                                                                const std::stop_token& stop = {});

  /// Bytes of the index of motions.
  std::size_t index_bytes() const { return spans_.bytes(); }
  /// Bytes of the cached tiles.
  std::size_t tile_bytes() const { return eras_.bytes(); }

 private:
  struct Wanted;
  struct ChangedTile;
  void add_wanted(FieldTile at, const MotionSet& set, std::vector<Wanted>& wanted,
                  std::vector<GroupJob>& jobs);
  std::expected<void, std::string> carve_some(std::span<const FieldTile> tiles,
                                              const MotionSet& set, Workers& workers,
                                              const std::stop_token& stop,
                                              std::vector<TileReplacement>& carved);
  void keep(std::span<Wanted> wanted, std::span<const GroupJob> jobs);
  std::vector<ChangedTile> changed_tiles(const SolidSnapshot& solid,
                                         std::span<const FieldTile> tiles, const StrokeSet& changed,
                                         const MotionSet& set) const;
  std::expected<std::vector<std::shared_ptr<const DexelTile>>, std::string> find_returning(
      std::vector<ChangedTile>& tiles, const MotionSet& set, Workers& workers,
      const std::stop_token& stop);
  const DexelGrid& grid(RayAxis axis) const;

  RecordedMotions motions_;
  GroupCarver carver_;
  GroupCarver shape_carver_;  ///< keeps no normals
  ReturnCarver return_carver_;
  SculptureSettings shape_settings_;  ///< keep no normals
  SolidSnapshot start_;
  std::vector<DexelGrid> grids_;
  double tolerance_mm_;
  double margin_mm_ = 0;  ///< greatest distance of ends from the sweep of a motion
  MotionSpans spans_;
  EraTiles eras_;
  std::vector<FieldTile> reached_;  ///< by one motion; reuses its memory
  std::uint64_t questions_ = 0;     ///< asked so far
  std::size_t tile_bytes_max_;
};

}  // namespace kerf
