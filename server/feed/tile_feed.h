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
/// once for all of them, and only when one of them is about to get it; newer versions replace older
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
  struct CachedTile {
    EncodedTile encoded;          ///< version 0: not meshed yet
    std::uint64_t mesh_hash = 0;  ///< of the mesh that was encoded
    bool stale = true;            ///< columns that it reads have changed since it was meshed
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
  struct Viewer {
    std::uint64_t sent = 0, acked = 0;   ///< frame sequences
    std::uint64_t revision = 0;          ///< of the last frame
    std::vector<std::uint32_t> version;  ///< per tile; 0: never sent
    TileQueue first;                     ///< tiles of the first snapshot that have not been sent
    TileQueue changed;                   ///< tiles that have changed since they were sent
    std::vector<bool> in_changed;
    bool lacks_nothing() const { return first.empty() && changed.empty(); }
  };
  struct ComposedFrame {
    std::vector<std::uint64_t> key;  ///< revisions and the tiles with their versions
    std::shared_ptr<const std::vector<std::byte>> glb;
  };

  void take_news();
  const EncodedTile& current(std::uint32_t tile);
  std::size_t pick_tiles(Viewer& viewer, TileQueue& queue, std::size_t bytes, std::size_t bytes_max,
                         std::vector<std::uint32_t>& picked);
  std::shared_ptr<const std::vector<std::byte>> compose(const std::vector<std::uint32_t>& tiles,
                                                        std::uint64_t from);

  const FeedSettings settings_;
  const MeshQuantization quantization_;

  mutable std::mutex news_mutex_;  ///< guards the next three; held for moments only
  SolidSnapshot news_snapshot_;
  std::vector<TileIndex> news_tiles_;
  std::uint64_t news_revision_ = 0;

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
