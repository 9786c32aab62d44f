// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "server/feed/mesh_glb.h"
#include "server/feed/tile_detail.h"

namespace kerf {

/// Names a viewer within one feed.
using ViewerId = std::uint32_t;

struct FeedSettings {
  std::size_t frame_bytes_max = 256 * 1024;  ///< a frame ends with the tile that reaches it
  std::uint32_t frames_in_flight_max = 2;    ///< the credit: frames sent and not yet acknowledged
  TileCompression compression = TileCompression::kMeshopt;
};

/// One mesh message for one viewer. The GLB is shared by all viewers that get the same tiles.
struct FeedFrame {
  std::uint64_t sequence = 0;  ///< per viewer, from 1, for the frame's header; ack names it
  std::uint8_t flags = 0;      ///< kFirstSnapshot, kFirstSnapshotEnd
  std::shared_ptr<const std::vector<std::byte>> glb;
};
inline constexpr std::uint8_t kFirstSnapshot = 1;     ///< part of the viewer's first snapshot
inline constexpr std::uint8_t kFirstSnapshotEnd = 2;  ///< and its last part

/// Brings the surface of one changing block to many viewers: a changed tile is meshed and encoded
/// once for all of them (once for each level of detail that they show), and only when one of them
/// is about to get it; newer versions replace older
/// ones that have not been sent (a viewer has a set of tiles that it lacks, not a queue of frames);
/// nobody has more than `frames_in_flight_max` frames under way.
///
/// No thread and no clock of its own. Threads: note_change may be called from the session's thread
/// and never waits for meshing; everything else belongs to the viewer lane (any number of threads,
/// one lock inside, held while tiles are meshed).
class TileFeed {
 public:
  /// `revision` names the state that the snapshot shows (the session's count of motions): it only
  /// grows.
  TileFeed(SolidSnapshot snapshot, std::uint64_t revision, FeedSettings settings = {});

  /// The block as it is now, and the tiles that were cut since the last call
  /// (MotionResult::changed_tiles, in any order, repeats allowed). Call it as often as viewers
  /// should see news, 20 to 30 times a second; cost: a few pointer moves.
  void note_change(SolidSnapshot snapshot, std::span<const TileIndex> changed,
                   std::uint64_t revision);

  ViewerId add_viewer();
  void remove_viewer(ViewerId viewer);  ///< unknown viewers are ignored
  std::size_t viewers() const;
  /// From where a viewer looks from now on: tiles that may be coarser, or must be finer, are sent
  /// anew. Until the first look everything is as exact as it is. Unknown viewers are ignored. Costs
  /// a few operations per tile of the block.
  void look(ViewerId viewer, const ViewerLook& look);

  /// The next frame for a viewer; nothing while it has no credit or lacks nothing. Call it again
  /// until it gives nothing: after note_change (for each viewer), after ack, after add_viewer.
  std::optional<FeedFrame> next_frame(ViewerId viewer);
  /// The viewer has applied every frame up to `sequence`. False (and no effect) for a frame it was
  /// never sent or an unknown viewer: a protocol error of the peer.
  bool ack(ViewerId viewer, std::uint64_t sequence);

  struct ViewerState {
    std::uint64_t revision = 0;  ///< newest revision of the feed
    bool sent = false;           ///< every tile of that revision has been handed out by next_frame
    bool applied = false;        ///< and acknowledged: the viewer shows exactly that revision
    std::uint32_t frames_in_flight = 0;
  };
  /// Nothing for an unknown viewer.
  std::optional<ViewerState> viewer_state(ViewerId viewer) const;
  /// The newest snapshot and its revision, e.g. to hash it off the session's thread.
  std::pair<SolidSnapshot, std::uint64_t> newest() const;

  /// Counters since construction, for /metrics.
  struct Stats {
    std::uint64_t tiles_meshed = 0, tiles_unchanged = 0, triangles_meshed = 0;
    std::uint64_t frames_composed = 0, frames_shared = 0, bytes_composed = 0;
  };
  Stats stats() const;

 private:
  using SharedTile = std::shared_ptr<const EncodedTile>;
  struct Form {
    TileDetail detail;
    SharedTile encoded;
  };
  struct CachedTile {
    std::uint32_t version = 0;    ///< 0: not meshed yet
    std::uint64_t mesh_hash = 0;  ///< of that version
    bool stale = true;            ///< columns that it reads have changed since it was meshed
    std::deque<Form> forms;       ///< of that version, as far as somebody has asked for them
  };
  /// Tiles to look at, oldest first.
  class TileQueue {
   public:
    bool empty() const { return head_ == tiles_.size(); }
    void push(std::uint32_t tile) { tiles_.push_back(tile); }
    std::uint32_t pop();

   private:
    std::vector<std::uint32_t> tiles_;
    std::size_t head_ = 0;
  };
  struct Shown {
    std::uint32_t version = 0;  ///< 0: never sent
    TileDetail detail;
  };
  struct Viewer {
    std::uint64_t sent = 0, acked = 0;  ///< frame sequences
    std::uint64_t revision = 0;         ///< of the last frame
    std::vector<Shown> shown;           ///< per tile
    std::vector<std::uint8_t> level;    ///< per tile: the one that it should have
    TileQueue first;                    ///< tiles of the first snapshot that have not been sent
    TileQueue changed;                  ///< tiles that have changed since they were sent
    std::vector<bool> in_changed;
    bool lacks_nothing() const { return first.empty() && changed.empty(); }
    /// The tile is to be looked at, unless it waits in the first snapshot, or here, anyway.
    void note(std::uint32_t tile);
  };
  struct ComposedFrame {
    std::vector<std::uint64_t> key;  ///< revisions, and the tiles with their versions and details
    std::shared_ptr<const std::vector<std::byte>> glb;
  };

  void take_update();
  struct Picked {
    std::uint32_t tile = 0;
    Form form;
  };

  TileIndex index_of(std::uint32_t tile) const;
  TileDetail detail_of(const Viewer& viewer, std::uint32_t tile) const;
  SharedTile current(std::uint32_t tile, const TileDetail& detail);
  std::size_t pick_tiles(Viewer& viewer, TileQueue& queue, std::size_t bytes, std::size_t bytes_max,
                         std::vector<Picked>& picked);
  std::shared_ptr<const std::vector<std::byte>> compose(const std::vector<Picked>& tiles,
                                                        std::uint64_t from);

  const FeedSettings settings_;
  const MeshQuantization quantization_;

  mutable std::mutex update_mutex_;  ///< guards the next three; held for moments only
  SolidSnapshot update_snapshot_;
  std::vector<TileIndex> update_tiles_;
  std::uint64_t update_revision_ = 0;

  mutable std::mutex lane_mutex_;  ///< guards everything below
  SolidSnapshot snapshot_;
  std::uint64_t revision_ = 0;
  std::vector<CachedTile> tiles_;  ///< row-major
  std::unordered_map<ViewerId, Viewer> viewers_;
  ViewerId next_viewer_ = 1;
  std::deque<ComposedFrame> recent_;  ///< the last few frames, for viewers in step
  Stats stats_;
};

}  // namespace kerf
