// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/tile_region.h"
#include "kernel/sculpture.h"
#include "kernel/tool/tool_bounds.h"
#include "server/wire/types.h"

namespace kerf {

/// The tool of an agent, around which its replica must be correct.
struct TrackedTool {
  const Tool& tool;
  ToolPose pose;
  std::uint64_t time_us = 0;  ///< of the agent's newest sample, by its clock
};

/// One patch for the replica of an agent.
struct StockUpdate {
  std::uint64_t sequence = 0;  ///< per feed, from 1; goes into the frame's header
  bool reset = false;          ///< discard the replica before applying the tiles
  /// Each tile starts over from uncut stock. One without columns is unknown from then on.
  bool returned = false;
  std::uint64_t agent_time_us = 0;  ///< samples up to here are cut from the tiles, or rejected
  struct Tile {
    FieldTile at;
    std::vector<std::byte> columns;  ///< encoded by stock_columns.h; empty: unchanged
  };
  std::vector<Tile> tiles;

  /// Converts to the wire type, which points into this object.
  wire::StockPatch patch() const;
};

/// Keeps the replica of one agent correct around its tool and along the tool's predicted path. The
/// agent cuts its own motions itself, so it needs a tile once, when the tool approaches, and then
/// only the columns that other participants cut, until stock comes back to the tile. Has no clock
/// and no thread. Runs on the session's executor.
class StockFeed {
 public:
  /// A patch ends with the tile that reaches this number of bytes of columns.
  static constexpr std::size_t kPatchBytes = std::size_t{32} * 1024;

  /// `takes_returned`: the agent understands patches with `returned`. Otherwise its replica starts
  /// over when stock comes back. `whole`: the replica should be correct everywhere, unless a field
  /// has more than 1,024 tiles.
  explicit StockFeed(bool takes_returned = false, bool whole = false)
      : takes_returned_(takes_returned), whole_(whole) {}

  /// Marks tiles that another participant cut.
  void note_cut(std::span<const FieldTile> tiles);
  /// Stock has come back to these tiles: the replica is invalid there.
  void note_returned(std::span<const FieldTile> tiles);
  /// The agent's replica is invalid: the next patch starts a new one.
  void reset();
  /// Returns the patch that the replica lacks around the tool and its predicted path, nearest tiles
  /// first, or nullopt if it is complete, or if as many patches are in flight as wire/limits.h
  /// allows. The cost is proportional to the number of tiles in that region.
  std::optional<StockUpdate> next(const Sculpture& sculpture, const TrackedTool& tracked);
  /// The agent applied every patch up to `sequence`. Returns false, without effect, if that patch
  /// was not sent.
  bool ack(std::uint64_t sequence);
  /// Returns the bytes of the stored copies of tiles, their heap memory included.
  std::size_t bytes() const;

 private:
  /// Limit of the tiles of a region, per field, to bound the time taken from other participants.
  /// Above it, the predicted path is dropped. If the region is still larger, nothing is sent.
  static constexpr std::int64_t kTilesMax = 16384;

  struct MissingTile {
    double distance_mm;
    FieldTile at;
  };
  /// The tiles of each field where the replica must be correct, or empty for an absent field.
  using Regions = std::array<TileRegion, 3>;

  std::optional<Regions> everything(const Sculpture& sculpture) const;
  std::optional<Regions> reach(const Sculpture& sculpture, const TrackedTool& tracked);
  std::vector<MissingTile> missing(const Sculpture& sculpture, const Regions& near,
                                   Vec3 tip_mm) const;
  /// Adds the tiles to which stock has come back to the update, those in `near` with columns, and
  /// returns the bytes of these columns.
  std::size_t add_returned(const Sculpture& sculpture, const std::vector<MissingTile>& near,
                           StockUpdate& update);
  bool add_tile(const DexelField& field, FieldTile at, StockUpdate& update);
  void drop_far(const Regions& near);

  /// The tiles that the agent has, as they were sent, or null if the tile was untouched or is far
  /// away now.
  std::map<FieldTile, std::unique_ptr<DexelTile>> known_;
  std::set<FieldTile> stale_;     ///< those of known_ that another participant has cut since
  std::set<FieldTile> returned_;  ///< the agent lacks stock that has come back there
  Regions complete_;              ///< every tile in these regions is known
  std::uint64_t sent_ = 0;
  std::deque<std::size_t> in_flight_;  ///< bytes of each patch without an ack
  std::size_t bytes_in_flight_ = 0;
  Vec3 last_tip_mm_;           ///< at the previous call of next()
  std::uint64_t last_us_ = 0;  ///< time of that call
  bool takes_returned_ = false;
  bool whole_ = false;
  bool reset_ = true;
};

}  // namespace kerf
