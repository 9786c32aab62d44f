// SPDX-License-Identifier: Apache-2.0
#include "server/feed/stock_feed.h"

#include <algorithm>
#include <cmath>

#include "kernel/dexel/dexel_field.h"
#include "server/convert/stock_columns.h"
#include "server/wire/limits.h"

namespace kerf {
namespace {

constexpr RayAxis kAxes[] = {RayAxis::kZ, RayAxis::kX, RayAxis::kY};
/// Margin around the tool: stock within it may be touched before the next patch arrives.
constexpr double kReachMm = 6;
/// Prediction time of the tool's path, at constant velocity: longer than any round trip at which an
/// agent renders force.
constexpr double kAheadS = 0.4;
constexpr double kAheadMaxMm = 60;
/// Number of patches between clean-ups of the stored copies of distant tiles.
constexpr std::uint64_t kDropFarEvery = 64;
/// Most tiles of a field that are all sent: each patch checks them until they are.
constexpr std::int64_t kWholeTilesMax = 1024;

/// Returns the region that affects the surface that a tool within `box` changes: tiles of the field
/// along Z, their neighbors, whose surface changes with them, and one more, over the full height.
Bounds with_surface(const Bounds& box, const DexelGrid& grid) {
  Bounds all = grown(box, 2 * kTileSide * grid.pitch_mm);
  all.lo_mm.z = grid.origin_mm.z;
  all.hi_mm.z = grid.z_mm(grid.height_quanta);
  return all;
}

}  // namespace

wire::StockPatch StockUpdate::patch() const {
  wire::StockPatch patch;
  patch.reset = reset;
  patch.returned = returned;
  patch.agent_time_us = agent_time_us;
  for (const Tile& tile : tiles) {
    patch.tiles.push_back({static_cast<std::uint32_t>(tile.at.axis),
                           static_cast<std::uint32_t>(tile.at.tile.x),
                           static_cast<std::uint32_t>(tile.at.tile.y), tile.columns});
  }
  return patch;
}

void StockFeed::note_cut(std::span<const FieldTile> tiles) {
  for (const FieldTile& tile : tiles) {
    if (known_.contains(tile)) stale_.insert(tile);
  }
}

void StockFeed::note_returned(std::span<const FieldTile> tiles) {
  if (tiles.empty() || reset_) return;
  // A replica also cuts where it has no tile yet, and those cuts must not outlast an undo.
  returned_.insert(tiles.begin(), tiles.end());
  if (!takes_returned_ || returned_.size() > wire::kMaxStockTiles) return reset();
  for (const FieldTile& tile : tiles) {
    known_.erase(tile);
    stale_.erase(tile);
  }
  complete_ = {};
}

void StockFeed::reset() {
  known_.clear();
  stale_.clear();
  returned_.clear();
  complete_ = {};
  reset_ = true;
}

/// Returns all tiles if the replica should have them and there are not too many.
std::optional<StockFeed::Regions> StockFeed::everything(const Sculpture& sculpture) const {
  if (!whole_) return std::nullopt;
  Regions all;
  for (std::size_t n = 0; n < all.size(); ++n) {
    const DexelField* field = sculpture.field(kAxes[n]);
    if (field == nullptr) continue;
    all[n] = {{0, 0}, {field->grid().tiles_x(), field->grid().tiles_y()}};
    if (all[n].count() > kWholeTilesMax) return std::nullopt;
  }
  return all;
}

/// Returns the tiles that the tool may reach before the next patches arrive, or nullopt if there
/// are more than kTilesMax.
std::optional<StockFeed::Regions> StockFeed::reach(const Sculpture& sculpture,
                                                   const TrackedTool& tracked) {
  if (auto all = everything(sculpture)) return all;
  constexpr double kSPerUs = 1e-6;
  ToolPose later = tracked.pose;
  if (last_us_ != 0 && tracked.time_us > last_us_) {
    const double passed_s = static_cast<double>(tracked.time_us - last_us_) * kSPerUs;
    const Vec3 ahead = (tracked.pose.tip_mm - last_tip_mm_) * (kAheadS / passed_s);
    const double far = length(ahead);
    later.tip_mm = later.tip_mm + ahead * (far > kAheadMaxMm ? kAheadMaxMm / far : 1);
  }
  last_tip_mm_ = tracked.pose.tip_mm;
  last_us_ = tracked.time_us;
  const Bounds now = tool_bounds(tracked.tool, tracked.pose);
  for (const Bounds& bounds : {joined(now, tool_bounds(tracked.tool, later)), now}) {
    const Bounds near = grown(bounds, kReachMm);
    const Bounds box = whole_ ? with_surface(near, sculpture.grid()) : near;
    Regions regions;
    bool small = true;
    for (std::size_t n = 0; n < regions.size(); ++n) {
      const DexelField* field = sculpture.field(kAxes[n]);
      if (field == nullptr) continue;
      regions[n] = tiles_through(field->grid(), box.lo_mm, box.hi_mm);
      small = small && regions[n].count() <= kTilesMax;
    }
    if (small) return regions;
  }
  return std::nullopt;
}

std::vector<StockFeed::MissingTile> StockFeed::missing(const Sculpture& sculpture,
                                                       const Regions& near, Vec3 tip_mm) const {
  std::vector<MissingTile> list;
  for (std::size_t n = 0; n < near.size(); ++n) {
    const DexelField* field = sculpture.field(kAxes[n]);
    if (field == nullptr) continue;
    const DexelGrid& grid = field->grid();
    const Vec3 tip = to_frame(grid.axis, tip_mm);
    const auto add = [&](TileIndex tile) {
      constexpr double kHalf = kTileSide / 2.0;
      const double x = grid.origin_mm.x + (tile.x * kTileSide + kHalf) * grid.pitch_mm - tip.x;
      const double y = grid.origin_mm.y + (tile.y * kTileSide + kHalf) * grid.pitch_mm - tip.y;
      list.push_back({std::hypot(x, y), {grid.axis, tile}});
    };
    near[n].all_of([&](TileIndex tile) {
      if (!complete_[n].has(tile) && !known_.contains({grid.axis, tile})) add(tile);
      return true;
    });
    for (const FieldTile& at : stale_) {
      if (at.axis == grid.axis && near[n].has(at.tile)) add(at.tile);
    }
  }
  std::ranges::sort(list, {}, &MissingTile::distance_mm);
  return list;
}

/// Adds a tile to the update unless the agent has it unchanged. Returns whether it was added.
bool StockFeed::add_tile(const DexelField& field, FieldTile at, StockUpdate& update) {
  const auto [known, is_new] = known_.try_emplace(at);
  stale_.erase(at);
  const DexelTile* tile = field.find(at.tile);
  std::vector<std::byte> columns;
  if (tile != nullptr) {
    columns = encode_columns(*tile, known->second.get());
    known->second = std::make_unique<DexelTile>(*tile);
    // Normals are not sent. An empty list in braces would keep the vector's memory.
    known->second->topmost_codes = std::vector<EndCodes>();
    known->second->lower_codes = LowerElements<EndCodes>();
  }
  if (columns.empty() && !is_new) return false;
  update.tiles.push_back({at, std::move(columns)});
  return true;
}

std::size_t StockFeed::add_returned(const Sculpture& sculpture,
                                    const std::vector<MissingTile>& near, StockUpdate& update) {
  update.returned = true;
  std::size_t bytes = 0;
  for (const MissingTile& tile : near) {
    if (bytes >= kPatchBytes) break;
    const DexelField& field = *sculpture.field(tile.at.axis);
    // A tile that is whole again has no columns: it becomes unknown, and is sent in the next patch.
    if (!returned_.contains(tile.at) || field.find(tile.at.tile) == nullptr) continue;
    add_tile(field, tile.at, update);
    bytes += update.tiles.back().columns.size();
    returned_.erase(tile.at);
  }
  for (const FieldTile& at : returned_) update.tiles.push_back({at, {}});
  returned_.clear();
  return bytes;
}

void StockFeed::drop_far(const Regions& near) {
  for (auto& [at, sent] : known_) {
    const auto n = std::size_t(std::ranges::find(kAxes, at.axis) - std::begin(kAxes));
    if (!near[n].has(at.tile)) sent.reset();
  }
}

std::optional<StockUpdate> StockFeed::next(const Sculpture& sculpture, const TrackedTool& tracked) {
  if (in_flight_.size() >= wire::kStockFramesInFlight ||
      bytes_in_flight_ >= wire::kStockBytesInFlight) {
    return std::nullopt;
  }
  const auto near = reach(sculpture, tracked);
  if (!near) return std::nullopt;
  StockUpdate update;
  update.reset = reset_;
  update.agent_time_us = tracked.time_us;
  const std::vector<MissingTile> list = missing(sculpture, *near, tracked.pose.tip_mm);
  std::size_t bytes = 0;
  if (returned_.empty()) {
    std::size_t processed = 0;
    for (; processed < list.size() && bytes < kPatchBytes; ++processed) {
      if (update.tiles.size() == wire::kMaxStockTiles) break;
      const FieldTile& at = list[processed].at;
      if (add_tile(*sculpture.field(at.axis), at, update)) {
        bytes += update.tiles.back().columns.size();
      }
    }
    if (processed == list.size()) complete_ = *near;
  } else {
    bytes = add_returned(sculpture, list, update);
  }
  if (update.tiles.empty() && !reset_) return std::nullopt;
  reset_ = false;
  update.sequence = ++sent_;
  in_flight_.push_back(bytes);
  bytes_in_flight_ += bytes;
  if (sent_ % kDropFarEvery == 0) drop_far(*near);
  return update;
}

std::size_t StockFeed::bytes() const {
  std::size_t bytes = 0;
  for (const auto& [at, sent] : known_) bytes += sent ? sent->bytes() : 0;
  return bytes;
}

bool StockFeed::ack(std::uint64_t sequence) {
  if (sequence > sent_) return false;
  while (!in_flight_.empty() && sent_ - in_flight_.size() < sequence) {
    bytes_in_flight_ -= in_flight_.front();
    in_flight_.pop_front();
  }
  return true;
}

}  // namespace kerf
