// SPDX-License-Identifier: Apache-2.0
#include "server/feed/tile_feed.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "server/feed/changed_columns.h"
#include "server/feed/column_digest.h"

namespace kerf {
namespace {

/// Number of encoded forms kept per tile, for viewers at different distances.
constexpr std::size_t kFormsMax = 6;

/// Hashes a mesh (FNV-1a over words), to detect tiles whose mesh did not change before encoding
/// them.
std::uint64_t hash_of(const TileMesh& mesh) {
  std::uint64_t hash = 14695981039346656037U;
  const auto mix = [&hash](std::uint32_t word) {
    hash = (hash ^ word) * 1099511628211U;
    hash ^= hash >> 32U;
  };
  for (const auto* vectors : {&mesh.positions_mm, &mesh.normals}) {
    for (const auto& v : *vectors) {
      for (const float component : v) mix(std::bit_cast<std::uint32_t>(component));
    }
  }
  for (const std::uint32_t index : mesh.indices) mix(index);
  for (const std::uint8_t original : mesh.original) mix(original);
  return hash;
}

}  // namespace

std::uint32_t TileFeed::TileQueue::pop() {
  const std::uint32_t tile = tiles_[head_++];
  if (head_ == tiles_.size() || head_ > 4096) {
    tiles_.erase(tiles_.begin(), tiles_.begin() + static_cast<std::ptrdiff_t>(head_));
    head_ = 0;
  }
  return tile;
}

void TileFeed::Viewer::queue_change(std::uint32_t tile) {
  if (sent_tiles[tile].version == 0 || in_changed[tile]) return;
  in_changed[tile] = true;
  changed.push(tile);
}

TileFeed::TileFeed(SolidSnapshot snapshot, std::uint64_t revision, FeedSettings settings)
    : settings_(settings),
      quantization_(mesh_quantization(snapshot.grid())),
      update_snapshot_(snapshot),
      update_revision_(revision),
      snapshot_(std::move(snapshot)),
      revision_(revision) {
  const DexelGrid& grid = snapshot_.grid();
  tiles_.resize(static_cast<std::size_t>(grid.tiles_x()) *
                static_cast<std::size_t>(grid.tiles_y()));
}

void TileFeed::note_change(SolidSnapshot snapshot, std::span<const TileIndex> changed,
                           std::uint64_t revision) {
  const std::scoped_lock lock(update_mutex_);
  std::swap(update_snapshot_, snapshot);  // the old one is destroyed after unlocking
  update_tiles_.insert(update_tiles_.end(), changed.begin(), changed.end());
  std::sort(update_tiles_.begin(), update_tiles_.end());
  update_tiles_.erase(std::unique(update_tiles_.begin(), update_tiles_.end()), update_tiles_.end());
  update_revision_ = revision;
}

void TileFeed::begin_round() {
  const std::scoped_lock lock(mutex_);
  take_update();
  is_in_round_ = true;
}

void TileFeed::end_round() {
  const std::scoped_lock lock(mutex_);
  is_in_round_ = false;
}

void TileFeed::take_update() {
  if (is_in_round_) return;
  std::vector<TileIndex> changed;
  SolidSnapshot newest;
  {
    const std::scoped_lock lock(update_mutex_);
    if (update_revision_ == revision_ && update_tiles_.empty()) return;
    changed.swap(update_tiles_);
    newest = update_snapshot_;
    revision_ = update_revision_;
  }
  const SolidSnapshot before = std::exchange(snapshot_, std::move(newest));
  const DexelGrid& grid = snapshot_.grid();
  for (const TileIndex tile : tiles_that_read(grid, changed_columns(before, snapshot_, changed))) {
    const auto n = static_cast<std::uint32_t>(tile.y * grid.tiles_x() + tile.x);
    tiles_[n].stale = true;
    if (meshed_ == n) meshed_.reset();
    for (auto& [id, viewer] : viewers_) viewer.queue_change(n);
  }
}

ViewerId TileFeed::add_viewer(const std::optional<ViewerLook>& look, TileNodes nodes,
                              std::uint32_t budget) {
  const std::scoped_lock lock(mutex_);
  take_update();
  Viewer viewer;
  viewer.nodes = nodes;
  if (budget > 0) viewer.budget = ByteBudget(budget);
  viewer.sent_tiles.resize(tiles_.size());
  viewer.level.resize(tiles_.size());
  viewer.in_changed.resize(tiles_.size());
  if (look) {
    for (std::uint32_t n = 0; n < tiles_.size(); ++n) {
      viewer.level[n] = level_from(*look, n, 0);
    }
  }
  // Carved tiles first, because they are of most interest.
  for (const bool touched : {true, false}) {
    for (std::uint32_t n = 0; n < tiles_.size(); ++n) {
      if (snapshot_.touched(index_of(n)) == touched) viewer.first.push(n);
    }
  }
  viewers_.emplace(next_viewer_, std::move(viewer));
  return next_viewer_++;
}

void TileFeed::remove_viewer(ViewerId viewer) {
  const std::scoped_lock lock(mutex_);
  viewers_.erase(viewer);
}

std::size_t TileFeed::viewers() const {
  const std::scoped_lock lock(mutex_);
  return viewers_.size();
}

void TileFeed::look(ViewerId viewer_id, const ViewerLook& look) {
  const std::scoped_lock lock(mutex_);
  // First, so that viewers with equal viewpoints have the same tiles in the same order.
  take_update();
  const auto found = viewers_.find(viewer_id);
  if (found == viewers_.end()) return;
  Viewer& viewer = found->second;
  for (std::uint32_t n = 0; n < tiles_.size(); ++n) {
    const TileIndex tile = index_of(n);
    const std::uint8_t level = level_from(look, n, viewer.level[n]);
    if (level == viewer.level[n]) continue;
    viewer.level[n] = level;
    viewer.queue_change(n);
    for (const TileIndex side : kSides) {  // the borders of its neighbors may change too
      if (const auto neighbor = number_of({tile.x + side.x, tile.y + side.y})) {
        viewer.queue_change(*neighbor);
      }
    }
  }
}

void TileFeed::set_budget(ViewerId viewer_id, std::uint32_t bytes_per_s) {
  const std::scoped_lock lock(mutex_);
  const auto found = viewers_.find(viewer_id);
  if (found == viewers_.end()) return;
  auto& budget = found->second.budget;
  if (bytes_per_s == 0) {
    budget.reset();
  } else if (budget) {
    budget->set_bytes_per_s(bytes_per_s);
  } else {
    budget = ByteBudget(bytes_per_s);
  }
}

TileIndex TileFeed::index_of(std::uint32_t tile) const {
  const auto n = static_cast<std::int32_t>(tile);
  const std::int32_t tiles_x = snapshot_.grid().tiles_x();
  return {n % tiles_x, n / tiles_x};
}

std::optional<std::uint32_t> TileFeed::number_of(TileIndex index) const {
  const DexelGrid& grid = snapshot_.grid();
  if (index.x < 0 || index.y < 0 || index.x >= grid.tiles_x() || index.y >= grid.tiles_y()) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(index.y * grid.tiles_x() + index.x);
}

std::uint8_t TileFeed::level_from(const ViewerLook& look, std::uint32_t tile,
                                  std::uint8_t level) const {
  return static_cast<std::uint8_t>(detail_level(look, snapshot_.grid(), index_of(tile), level));
}

TileDetail TileFeed::detail_of(const Viewer& viewer, std::uint32_t tile) const {
  const TileIndex index = index_of(tile);
  TileDetail detail{.level = viewer.level[tile], .side = {}};
  for (std::size_t n = 0; n < kSides.size(); ++n) {
    const auto neighbor = number_of({index.x + kSides[n].x, index.y + kSides[n].y});
    detail.side[n] = neighbor ? std::min(detail.level, viewer.level[*neighbor]) : 0;
  }
  return detail;
}

const TileMesh& TileFeed::mesh_of(std::uint32_t tile) {
  if (meshed_ == tile) return mesh_;
  mesh_ = mesh_tile(snapshot_, index_of(tile));
  meshed_ = tile;
  ++stats_.tiles_meshed;
  stats_.triangles_meshed += mesh_.indices.size() / 3;
  return mesh_;
}

TileFeed::SharedTile TileFeed::current(std::uint32_t tile, const TileDetail& detail) {
  CachedTile& cached = tiles_[tile];
  const auto known = [&]() -> SharedTile {
    const auto found = std::ranges::find(cached.forms, detail, &Form::detail);
    return found == cached.forms.end() ? nullptr : found->encoded;
  };
  if (!cached.stale) {
    if (auto encoded = known()) return encoded;
  }
  const TileMesh& mesh = mesh_of(tile);
  if (std::exchange(cached.stale, false)) {
    const std::uint64_t hash = hash_of(mesh);
    const std::uint64_t digest = column_digest(snapshot_, index_of(tile));
    if (cached.version > 0 && cached.mesh_hash == hash && cached.digest == digest) {
      ++stats_.tiles_unchanged;
      if (auto encoded = known()) return encoded;
    } else {
      cached.mesh_hash = hash;
      cached.digest = digest;
      ++cached.version;
      cached.forms.clear();
    }
  }
  const TileMesh coarse =
      detail.level == 0 ? TileMesh{} : coarser_tile(mesh, snapshot_.grid(), detail);
  // A flat tile is exact at each level.
  const bool exact = detail.level == 0 || coarse.indices.size() == mesh.indices.size();
  EncodedTile encoded =
      encode_tile(exact ? mesh : coarse, quantization_, cached.version, settings_.compression);
  encoded.level = exact ? 0 : detail.level;
  encoded.digest = cached.digest;
  if (cached.forms.size() == kFormsMax) cached.forms.pop_front();
  cached.forms.push_back({detail, std::make_shared<const EncodedTile>(std::move(encoded))});
  return cached.forms.back().encoded;
}

bool TileFeed::ack(ViewerId viewer_id, std::uint64_t sequence) {
  const std::scoped_lock lock(mutex_);
  const auto found = viewers_.find(viewer_id);
  if (found == viewers_.end() || sequence > found->second.sent) return false;
  found->second.acked = std::max(found->second.acked, sequence);
  return true;
}

std::optional<TileFeed::ViewerState> TileFeed::viewer_state(ViewerId viewer_id) const {
  const std::scoped_lock lock(mutex_);
  const auto found = viewers_.find(viewer_id);
  if (found == viewers_.end()) return std::nullopt;
  const Viewer& viewer = found->second;
  ViewerState state;
  {
    const std::scoped_lock update_lock(update_mutex_);
    state.revision = update_revision_;
    state.sent = update_tiles_.empty() && viewer.has_all_tiles();
  }
  state.applied = state.sent && viewer.acked == viewer.sent;
  state.frames_in_flight = static_cast<std::uint32_t>(viewer.sent - viewer.acked);
  state.waits_for_budget = viewer.budget && !viewer.has_all_tiles();
  return state;
}

std::pair<SolidSnapshot, std::uint64_t> TileFeed::newest() const {
  const std::scoped_lock lock(update_mutex_);
  return {update_snapshot_, update_revision_};
}

TileFeed::Stats TileFeed::stats() const {
  const std::scoped_lock lock(mutex_);
  return stats_;
}

}  // namespace kerf
