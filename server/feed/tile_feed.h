// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "server/feed/byte_budget.h"
#include "server/feed/mesh_glb.h"
#include "server/feed/tile_detail.h"

namespace kerf {

/// Number of a viewer within one feed.
using ViewerId = std::uint32_t;

struct FeedSettings {
  std::size_t frame_bytes_max =
      std::size_t{256} * 1024;             ///< a frame ends with the tile that reaches it
  std::uint32_t frames_in_flight_max = 2;  ///< frames sent and not yet acknowledged
  TileCompression compression = TileCompression::kMeshopt;
};

/// One mesh message for one viewer. Viewers that receive the same tiles share the GLB.
struct FeedFrame {
  std::uint64_t sequence = 0;  ///< per viewer, from 1; goes into the frame's header
  std::uint8_t flags = 0;      ///< kFirstSnapshot, kFirstSnapshotEnd
  std::shared_ptr<const std::vector<std::byte>> glb;
  std::uint32_t sum = 0;  ///< its checksum (server/wire/checksum.h)
};
inline constexpr std::uint8_t kFirstSnapshot = 1;     ///< part of the viewer's first snapshot
inline constexpr std::uint8_t kFirstSnapshotEnd = 2;  ///< its last part

/// Sends the surface of a changing block to many viewers. A changed tile is meshed and encoded once
/// for all viewers (once per level of detail), when the first of them is about to receive it. For
/// each viewer the feed keeps a set of tiles to send rather than a queue of frames, so newer
/// versions replace older ones that were not sent. At most `frames_in_flight_max` frames per viewer
/// are in flight. A viewer with a budget gets coarser tiles while it does not suffice for exact
/// ones (README.md).
///
/// Has no thread and no clock. note_change() may be called on the session's thread and never waits
/// for meshing. All other functions are for the viewer threads. They take a lock that is held while
/// tiles are meshed.
class TileFeed {
 public:
  /// `revision` is the session's count of motions at the moment of the snapshot. It never
  /// decreases.
  TileFeed(SolidSnapshot snapshot, std::uint64_t revision, FeedSettings settings = {});

  /// Sets the current state of the block. `changed` are the tiles cut since the previous call
  /// (MotionResult::changed_tiles, in any order, repeats allowed). Call it at the display rate of
  /// the viewers, 20 to 30 times a second. It only moves a few pointers.
  void note_change(SolidSnapshot snapshot, std::span<const TileIndex> changed,
                   std::uint64_t revision);

  /// While a Round exists, all frames show the newest state at its beginning. So viewers share
  /// them, and a changed tile is meshed once, even if that takes longer than the block takes to
  /// change again. At most one at a time.
  class Round {
   public:
    explicit Round(TileFeed& feed) : feed_(feed) { feed_.begin_round(); }
    ~Round() { feed_.end_round(); }
    Round(const Round&) = delete;
    Round& operator=(const Round&) = delete;

   private:
    TileFeed& feed_;
  };

  /// Adds a viewer. Without a look all its tiles are exact. `budget`: bytes of its frames per
  /// second (0: unlimited).
  ViewerId add_viewer(const std::optional<ViewerLook>& look = std::nullopt,
                      TileNodes nodes = TileNodes::kSingle, std::uint32_t budget = 0);
  void remove_viewer(ViewerId viewer);  ///< unknown viewers are ignored
  std::size_t viewers() const;
  /// Sets the viewpoint of a viewer, and resends the tiles whose level of detail changes. Unknown
  /// viewers are ignored. Costs a few operations per tile of the block.
  void look(ViewerId viewer, const ViewerLook& look);
  /// Sets the budget of a viewer, bytes per second (0: unlimited). Unknown viewers are ignored.
  void set_budget(ViewerId viewer, std::uint32_t bytes_per_s);

  /// Returns the next frame for a viewer, or nullopt if it has every tile, or while the limit of
  /// frames in flight is reached or its budget is used up. Call it until it returns nullopt after
  /// note_change (for each viewer), ack, look and add_viewer, and at intervals while it waits for
  /// its budget. `now`, which never decreases, matters for viewers with a budget only.
  std::optional<FeedFrame> next_frame(ViewerId viewer, ByteBudget::Time now = {});
  /// The viewer applied every frame up to `sequence`. Returns false, without effect, for a frame
  /// that was not sent (a protocol error of the peer) or an unknown viewer.
  bool ack(ViewerId viewer, std::uint64_t sequence);

  struct ViewerState {
    std::uint64_t revision = 0;  ///< newest revision of the feed
    bool sent = false;     ///< next_frame has returned every tile of that revision at its level
    bool applied = false;  ///< and the viewer has acknowledged them
    std::uint32_t frames_in_flight = 0;
    bool waits_for_budget = false;  ///< the rest waits for its budget
  };
  /// Returns nullopt for an unknown viewer.
  std::optional<ViewerState> viewer_state(ViewerId viewer) const;
  /// Returns the newest snapshot and its revision, e.g. to hash it on another thread.
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
    std::uint64_t digest = 0;     ///< of its columns
    bool stale = true;            ///< its columns have changed since it was meshed
    std::deque<Form> forms;       ///< of that version, those that viewers need
  };
  /// Queue of tiles, oldest first.
  class TileQueue {
   public:
    bool empty() const { return head_ == tiles_.size(); }
    std::size_t size() const { return tiles_.size() - head_; }
    void push(std::uint32_t tile) { tiles_.push_back(tile); }
    std::uint32_t pop();

   private:
    std::vector<std::uint32_t> tiles_;
    std::size_t head_ = 0;
  };
  /// The state of a tile that a viewer was last sent.
  struct SentTile {
    std::uint32_t version = 0;  ///< 0: never sent
    TileDetail detail;
    std::uint8_t level = 0;        ///< of its mesh: a flat tile is exact at each level
    std::uint64_t shape_hash = 0;  ///< likewise
    std::uint64_t frame = 0;       ///< its sequence
  };
  struct Viewer {
    TileNodes nodes = TileNodes::kSingle;
    std::uint64_t sent = 0, acked = 0;  ///< frame sequences
    std::uint64_t revision = 0;         ///< of the last frame
    std::vector<SentTile> sent_tiles;   ///< per tile
    std::vector<std::uint8_t> level;    ///< per tile: the target level
    TileQueue first;                    ///< tiles of the first snapshot not sent yet
    TileQueue changed;                  ///< tiles changed since they were sent
    std::vector<bool> in_changed;
    std::optional<ByteBudget> budget;
    /// Tiles coarser than their level until the budget suffices, in the order of their frames.
    std::set<std::pair<std::uint64_t, std::uint32_t>> coarse;
    bool has_all_tiles() const { return first.empty() && changed.empty() && coarse.empty(); }
    /// Queues a changed tile unless it is queued already.
    void queue_change(std::uint32_t tile);
  };
  struct ComposedFrame {
    std::vector<std::uint64_t>
        key;  ///< revisions, nodes, and the tiles with their versions and details
    std::shared_ptr<const std::vector<std::byte>> glb;
    std::uint32_t sum = 0;
  };

  struct Picked {
    std::uint32_t tile = 0;
    Form form;
  };
  /// The tiles of the next frame of a viewer.
  struct Selection {
    std::vector<Picked> tiles;
    bool is_coarse = false;                    ///< the budget does not suffice for exact tiles
    std::unordered_set<std::uint64_t> shapes;  ///< of their meshes
    std::size_t bytes = 0;                     ///< of the frame, about
    std::uint64_t meshed_max = 0;              ///< Stats::tiles_meshed at which the frame ends
  };

  void begin_round();
  void end_round();
  void take_update();
  TileIndex index_of(std::uint32_t tile) const;
  /// Number of the tile at `index`, or nullopt outside the block.
  std::optional<std::uint32_t> number_of(TileIndex index) const;
  TileDetail detail_of(const Viewer& viewer, std::uint32_t tile) const;
  SharedTile current(std::uint32_t tile, const TileDetail& detail);
  /// The newest mesh of a tile. Valid until the next call.
  const TileMesh& mesh_of(std::uint32_t tile);
  /// Level of detail of a tile from a viewpoint. `level` is the present one.
  std::uint8_t level_from(const ViewerLook& look, std::uint32_t tile, std::uint8_t level) const;
  bool is_full(const Selection& selection, std::size_t bytes_max) const;
  void select_tiles(Viewer& viewer, TileQueue& queue, std::size_t bytes_max, Selection& selection);
  void select_coarse_tiles(Viewer& viewer, std::size_t bytes_max, Selection& selection);
  void select_tile(Viewer& viewer, std::uint32_t tile, Selection& selection);
  Picked coarser(Picked exact);
  /// Composes a frame, or finds it among the recent ones. Valid until the next call.
  const ComposedFrame& compose(const std::vector<Picked>& tiles, const Viewer& viewer);

  const FeedSettings settings_;
  const MeshQuantization quantization_;

  mutable std::mutex update_mutex_;  ///< guards the next three members; held briefly
  SolidSnapshot update_snapshot_;
  std::vector<TileIndex> update_tiles_;
  std::uint64_t update_revision_ = 0;

  mutable std::mutex mutex_;  ///< guards all members below
  SolidSnapshot snapshot_;
  std::uint64_t revision_ = 0;
  bool is_in_round_ = false;
  std::vector<CachedTile> tiles_;  ///< row-major
  std::unordered_map<ViewerId, Viewer> viewers_;
  ViewerId next_viewer_ = 1;
  std::optional<std::uint32_t> meshed_;  ///< the tile of `mesh_`, if that is its newest one
  TileMesh mesh_;
  std::deque<ComposedFrame> recent_;  ///< recent frames, shared by viewers in step
  Stats stats_;
};

}  // namespace kerf
