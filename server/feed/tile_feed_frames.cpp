// SPDX-License-Identifier: Apache-2.0
// The part of TileFeed that picks the tiles of a viewer's next frame and composes it.
#include <algorithm>
#include <utility>

#include "server/feed/tile_feed.h"
#include "server/wire/checksum.h"

namespace kerf {
namespace {

/// Approximate sizes in a frame: the JSON of a tile's mesh, and its node.
constexpr std::size_t kMeshJsonBytes = 900, kNodeBytes = 200;
/// A frame ends after so many newly meshed tiles, which take about 0.1 s, because other viewers
/// wait, and tiles that share a mesh take hardly any bytes.
constexpr std::uint64_t kMeshedMax = 200;
/// Number of frames kept for other viewers in step.
constexpr std::size_t kRecentFramesMax = 16;
/// Level of tiles for which a budget does not suffice at once. Coarser ones would hardly be
/// smaller, because their borders keep their level (README.md).
constexpr std::uint8_t kCoarseLevel = 1;
/// Approximate bytes of an exact carved tile in a frame.
constexpr std::size_t kExactTileBytes = 10'000;
/// Tiles encoded in at most so many bytes are always sent exactly: a coarser form would save
/// little.
constexpr std::size_t kSmallTileBytes = 2'500;

std::uint64_t word_of(const TileDetail& detail) {
  std::uint64_t word = detail.level;
  for (const std::uint8_t side : detail.side) word = word << 8U | side;
  return word;
}

}  // namespace

bool TileFeed::is_full(const Selection& selection, std::size_t bytes_max) const {
  return selection.bytes >= bytes_max ||
         (!selection.tiles.empty() && stats_.tiles_meshed >= selection.meshed_max);
}

TileFeed::Picked TileFeed::coarser(Picked exact) {
  const auto& [detail, encoded] = exact.form;
  if (detail.level >= kCoarseLevel || encoded->bytes() <= kSmallTileBytes) return exact;
  // Its borders keep their level, so neighbors need not be resent and there are no cracks.
  const TileDetail coarse{.level = kCoarseLevel, .side = detail.side};
  SharedTile simpler = current(exact.tile, coarse);
  if (simpler->bytes() >= encoded->bytes()) return exact;
  return {exact.tile, {coarse, std::move(simpler)}};
}

void TileFeed::select_tile(Viewer& viewer, std::uint32_t tile, Selection& selection) {
  SentTile& sent = viewer.sent_tiles[tile];
  const TileDetail wanted = detail_of(viewer, tile);
  Picked picked{tile, {wanted, current(tile, wanted)}};
  const auto was_sent = [&] {
    const EncodedTile& encoded = *picked.form.encoded;
    return sent.version == encoded.version &&
           (sent.detail == picked.form.detail ||
            (sent.level == encoded.level && sent.shape_hash == encoded.shape_hash));
  };
  if (was_sent()) return;
  if (selection.is_coarse) {
    picked = coarser(std::move(picked));
    if (was_sent()) return;
  }
  viewer.coarse.erase({sent.frame, tile});
  const EncodedTile& encoded = *picked.form.encoded;
  sent = {encoded.version, picked.form.detail, encoded.level, encoded.shape_hash, viewer.sent + 1};
  if (sent.detail != wanted) viewer.coarse.insert({sent.frame, tile});
  selection.bytes += kNodeBytes;
  if (selection.shapes.insert(picked.form.encoded->shape_hash).second) {
    selection.bytes += picked.form.encoded->bytes() + kMeshJsonBytes;
  }
  selection.tiles.push_back(std::move(picked));
}

void TileFeed::select_tiles(Viewer& viewer, TileQueue& queue, std::size_t bytes_max,
                            Selection& selection) {
  while (!queue.empty() && !is_full(selection, bytes_max)) {
    const std::uint32_t tile = queue.pop();
    if (&queue == &viewer.changed) viewer.in_changed[tile] = false;
    select_tile(viewer, tile, selection);
  }
}

/// Refines coarse tiles to their level, the longest unchanged first.
void TileFeed::select_coarse_tiles(Viewer& viewer, std::size_t bytes_max, Selection& selection) {
  selection.is_coarse = false;
  while (!viewer.coarse.empty() && !is_full(selection, bytes_max)) {
    const auto [frame, tile] = *viewer.coarse.begin();
    if (frame > viewer.sent) return;  // it is in this frame
    select_tile(viewer, tile, selection);
    viewer.coarse.erase({frame, tile});
  }
}

std::optional<FeedFrame> TileFeed::next_frame(ViewerId viewer_id, ByteBudget::Time now) {
  const std::scoped_lock lock(mutex_);
  take_update();
  const auto found = viewers_.find(viewer_id);
  if (found == viewers_.end()) return std::nullopt;
  Viewer& viewer = found->second;
  if (viewer.sent - viewer.acked >= settings_.frames_in_flight_max) return std::nullopt;

  const bool first_snapshot = !viewer.first.empty();
  Selection selection;
  std::size_t bytes_max = settings_.frame_bytes_max, bytes_to_spare = bytes_max;
  if (viewer.budget) {
    viewer.budget->fill(now);
    bytes_max = std::min(bytes_max, viewer.budget->left());
    bytes_to_spare = std::min(bytes_max, viewer.budget->left_to_spare());
    if (bytes_max == 0) return std::nullopt;
    const std::size_t waiting = viewer.changed.size() + viewer.first.size();
    selection.is_coarse = !viewer.coarse.empty() || waiting * kExactTileBytes > bytes_max;
  }
  // During the first snapshot, changes get at most half of a frame, so that neither starves the
  // other.
  const unsigned share = first_snapshot ? 2 : 1;
  selection.meshed_max = stats_.tiles_meshed + kMeshedMax / share;
  select_tiles(viewer, viewer.changed, bytes_max / share, selection);
  selection.meshed_max = stats_.tiles_meshed + kMeshedMax / share;
  select_tiles(viewer, viewer.first, bytes_max, selection);
  if (viewer.changed.empty() && viewer.first.empty()) {
    select_coarse_tiles(viewer, bytes_to_spare, selection);
  }
  if (selection.tiles.empty()) return std::nullopt;

  FeedFrame frame;
  if (first_snapshot) frame.flags |= kFirstSnapshot;
  if (first_snapshot && viewer.first.empty()) frame.flags |= kFirstSnapshotEnd;
  frame.sequence = ++viewer.sent;
  const ComposedFrame& composed = compose(selection.tiles, viewer);
  frame.glb = composed.glb;
  frame.sum = composed.sum;
  viewer.revision = revision_;
  if (viewer.budget) viewer.budget->take(frame.glb->size());
  return frame;
}

const TileFeed::ComposedFrame& TileFeed::compose(const std::vector<Picked>& tiles,
                                                 const Viewer& viewer) {
  std::vector<std::uint64_t> key{viewer.revision, revision_, std::uint64_t(viewer.nodes)};
  for (const auto& [tile, form] : tiles) {
    key.push_back(std::uint64_t{tile} << 32U | form.encoded->version);
    key.push_back(word_of(form.detail));
  }
  for (const ComposedFrame& recent : recent_) {
    if (recent.key != key) continue;
    ++stats_.frames_shared;
    return recent;
  }
  std::vector<const EncodedTile*> encoded;
  encoded.reserve(tiles.size());
  for (const Picked& picked : tiles) encoded.push_back(picked.form.encoded.get());
  auto glb = std::make_shared<const std::vector<std::byte>>(
      write_mesh_glb(encoded, quantization_, viewer.revision, revision_, viewer.nodes));
  ++stats_.frames_composed;
  stats_.bytes_composed += glb->size();
  if (recent_.size() == kRecentFramesMax) recent_.pop_front();
  // Used only by viewers that verify.
  const std::uint32_t sum = viewer.nodes == TileNodes::kVerified ? wire::checksum(*glb) : 0;
  recent_.push_back({std::move(key), std::move(glb), sum});
  return recent_.back();
}

}  // namespace kerf
