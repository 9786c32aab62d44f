// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptic_agent/replica/replica.h"
#include "kernel/dexel/solid_snapshot.h"
#include "kernel/surface/tile_mesh.h"
#include "web/wasm/own_strokes.h"

namespace kerf::page {

/// A tile of the field along Z. Three numbers of 32 bits: the page gets them as they are.
struct ChangedTile {
  TileIndex at;
  std::int32_t by_page;  ///< 1: a motion of the page has changed it
};

/// The page's copy of a block: the replica of an agent, with the surface of what has changed in it.
/// Not thread-safe; uses no clock.
class PageBlock {
 public:
  /// Reads the text of an agent's welcome. The error is one sentence.
  static std::expected<PageBlock, std::string> open(std::string_view welcome);

  /// Defines the tools of a `tools` message that are new. The error is one sentence.
  std::expected<void, std::string> define_tools(std::string_view message) {
    return replica_.define_tools(message);
  }

  /// Takes a frame as it was sent: cuts the motions of the page, takes the stock of the server, and
  /// compares the results of the server with its own. Frames of other types have no effect. Returns
  /// false if the page must ask for a reset of its stock: the frame is malformed, or the copy has
  /// diverged.
  bool take(std::span<const std::byte> frame);
  /// Returns the greatest cutting force of the motions in the page's newest frame, N.
  double force_n() const { return force_n_; }
  /// The page asks the server to undo its newest stroke, or to redo the one that it undid last: the
  /// surface changes at once, the state when the server's stock comes.
  void change(bool undone);
  /// The server has refused, or has sent all: the surface is that of the state.
  void settle() { strokes_.settle(); }

  /// Returns the tiles of the field along Z that have changed since the last call, with those whose
  /// mesh changes with them. Those that depend on tiles that the server has not sent
  /// yet follow when it has.
  std::vector<ChangedTile> changed();
  /// Returns the mesh of a tile, which must be in the grid, as the block was at the last changed().
  TileMesh mesh(TileIndex tile) const { return mesh_tile(shown_, tile); }
  /// Returns the hash of the block. It is the server's once the server has sent what others cut.
  std::uint64_t hash() { return replica_.solid().hash(); }
  /// Returns the hash of the block whose surface is displayed. For tests.
  std::uint64_t surface_hash() { return strokes_.solid(replica_).hash(); }

 private:
  explicit PageBlock(agent::Replica replica);

  agent::Replica replica_;
  OwnStrokes strokes_;
  std::vector<ChangedColumns> seen_;   ///< where rays not along Z may have changed since
  SolidSnapshot shown_;                ///< at the last changed()
  std::map<TileIndex, bool> waiting_;  ///< changed since they were returned; whether by the page
  bool has_cut_ = false;               ///< since the last changed()
  double force_n_ = 0;
};

}  // namespace kerf::page
