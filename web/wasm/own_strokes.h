// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "haptic_agent/replica/replica.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/solid_snapshot.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf::page {

/// The strokes of a page, and the block as it will be when the server has undone and redone those
/// that the page has asked it to: what undoing brings back is the tiles of before the stroke, less
/// what others have cut since. The server's block stays that of the replica, so what is expected
/// never enters it; the expectation ends with the server's tiles. It is wrong until then where
/// others cut in a volume that the stroke had removed already. Not thread-safe; uses no clock.
class OwnStrokes {
 public:
  /// Tiles of before strokes that are kept; the oldest strokes are given up, and undone by the
  /// server alone. A tile takes 13 kB.
  static constexpr std::size_t kTilesMax = 4096;

  /// Returns the expected block: the replica if nothing else is expected.
  SolidSnapshot solid(agent::Replica& replica) {
    return ahead_ ? ahead_->solid() : replica.solid();
  }
  /// Gives the replica its next sample. Appends where the surface of the expected block changes, if
  /// it has rays that are not along Z.
  void move(agent::Replica& replica, const wire::MotionSample& sample,
            std::vector<ChangedColumns>& seen);
  /// The page asks the server to undo its newest stroke, or to redo the one that it undid last.
  /// Appends likewise.
  void change(agent::Replica& replica, bool undone, std::vector<ChangedColumns>& seen);
  /// The replica has taken a patch, before which it was `before`.
  void take(agent::Replica& replica, const wire::StockPatch& patch, const SolidSnapshot& before);
  /// Expects nothing any more: the server has refused, or nothing has come for long.
  void settle();

 private:
  /// Null: untouched.
  using TilePtr = std::shared_ptr<const DexelTile>;
  struct Stroke {
    /// The tiles that it has changed: without it; with it while it is undone.
    std::map<FieldTile, TilePtr> other = {};
    bool is_known = true;  ///< false: the server alone can undo or redo it
    void forget() { *this = {.is_known = false}; }
  };

  bool is_pending(FieldTile at) const;
  void begin_stroke();
  void take_tiles(agent::Replica& replica, const wire::StockPatch& patch,
                  const SolidSnapshot& before);
  void take_returned(agent::Replica& replica, const wire::StockPatch& patch);
  void take_foreign(const wire::StockPatch& patch);
  void take_away(FieldTile at, const DexelField& field, const TilePtr& was, const TilePtr& is);
  void forget(FieldTile at);
  void forget_all();
  void end_if_done();
  void end();

  std::deque<Stroke> done_, undone_;  ///< the newest last
  /// The block with what is expected; none while nothing is.
  std::optional<Sculpture> ahead_;
  /// Of each undo and redo that the server has not carried out, the tiles that it is to name.
  std::deque<std::set<FieldTile>> pending_;
  std::set<FieldTile> awaited_;        ///< named, and not sent yet
  std::optional<SolidSnapshot> base_;  ///< before the present stroke, or later where it has not cut
  bool in_stroke_ = false;
};

}  // namespace kerf::page
