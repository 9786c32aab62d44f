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

/// Where an agent's tool is.
struct ToolWatch {
  const Tool& tool;
  ToolPose pose;
  std::uint64_t time_us = 0;  ///< of the agent's newest sample, by its clock
};

/// What one agent is to be told of the block.
struct StockUpdate {
  std::uint64_t sequence = 0;  ///< per feed, from 1, for the frame's header; ack names it
  bool reset = false;
  std::uint64_t agent_time_us = 0;  ///< samples up to here are cut out of the tiles, or rejected
  struct Tile {
    FieldTile at;
    std::vector<std::byte> columns;  ///< stock_columns.h; none: the agent has all there is to know
  };
  std::vector<Tile> tiles;

  /// As the wire wants it; it points into this.
  wire::StockPatch patch() const;
};

/// Keeps one agent's copy of the block right where its tool is and soon will be. Stock only shrinks
/// and the agent takes away itself what its own tool removes, so it needs a tile once, when it
/// comes near, and again only when somebody else has cut it; then only the columns that changed. No
/// clock and no thread: it belongs to the session's executor.
class StockFeed {
 public:
  /// Bytes of columns after which a patch ends.
  static constexpr std::size_t kPatchBytes = 32 * 1024;

  /// Somebody else has cut these.
  void note_cut(std::span<const FieldTile> tiles);
  /// The agent's copy can no longer be trusted: the next patch begins a new one.
  void restart();
  /// What the agent lacks near its tool and where the tool is going, the nearest tiles first;
  /// nothing while it lacks nothing or has what wire/limits.h allows under way. Costs an operation
  /// for each tile near by.
  std::optional<StockUpdate> next(const Sculpture& sculpture, const ToolWatch& watch);
  /// The agent has every patch up to `sequence`. False (and no effect) for one it was never sent.
  bool ack(std::uint64_t sequence);

 private:
  /// A region of more tiles than this, in any field, is looked at without where the tool is going,
  /// or not at all: a copy of so fine a block would cost the others' time.
  static constexpr std::int64_t kTilesMost = 16384;

  struct Lacking {
    double distance_mm;
    FieldTile at;
  };
  /// The tiles of each field that the tool may reach; empty for a field that is not there.
  using Regions = std::array<TileRegion, 3>;

  std::optional<Regions> reach(const Sculpture& sculpture, const ToolWatch& watch);
  std::vector<Lacking> lacking(const Sculpture& sculpture, const Regions& near, Vec3 tip_mm) const;
  bool tell(const DexelField& field, FieldTile at, StockUpdate& news);
  void forget_far(const Regions& near);

  /// The tiles that the agent knows, as they were sent; null if one was untouched, or is far away
  /// by now.
  std::map<FieldTile, std::unique_ptr<DexelTile>> known_;
  std::set<FieldTile> stale_;  ///< of these, those that somebody else has cut since
  Regions complete_;           ///< every tile here is known
  std::uint64_t sent_ = 0;
  std::deque<std::size_t> under_way_;  ///< bytes of the patches that are not acknowledged
  std::size_t bytes_under_way_ = 0;
  Vec3 last_tip_mm_;  ///< at the last call of next, and when that was
  std::uint64_t last_us_ = 0;
  bool reset_ = true;
};

}  // namespace kerf
