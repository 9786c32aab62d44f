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
/// What is nearer to the tool than this may be touched before another patch arrives.
constexpr double kReachMm = 6;
/// So far ahead the tool is expected to go on as it goes now: longer than any round trip at which
/// an agent shows force.
constexpr double kAheadS = 0.4;
constexpr double kAheadMostMm = 60;
/// Every so many patches the copies of tiles that are far away are given up.
constexpr std::uint64_t kForgetEvery = 64;

}  // namespace

wire::StockPatch StockUpdate::patch() const {
  wire::StockPatch patch;
  patch.reset = reset;
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

void StockFeed::restart() {
  known_.clear();
  stale_.clear();
  complete_ = {};
  reset_ = true;
}

/// What the tool may reach before the next patches arrive; nothing if that is too much to look at.
std::optional<StockFeed::Regions> StockFeed::reach(const Sculpture& sculpture,
                                                   const ToolWatch& watch) {
  constexpr double kSPerUs = 1e-6;
  ToolPose later = watch.pose;
  if (last_us_ != 0 && watch.time_us > last_us_) {
    const double passed_s = static_cast<double>(watch.time_us - last_us_) * kSPerUs;
    const Vec3 ahead = (watch.pose.tip_mm - last_tip_mm_) * (kAheadS / passed_s);
    const double far = length(ahead);
    later.tip_mm = later.tip_mm + ahead * (far > kAheadMostMm ? kAheadMostMm / far : 1);
  }
  last_tip_mm_ = watch.pose.tip_mm;
  last_us_ = watch.time_us;
  const Bounds now = tool_bounds(watch.tool, watch.pose);
  for (const Bounds& wish : {joined(now, tool_bounds(watch.tool, later)), now}) {
    const Bounds box = grown(wish, kReachMm);
    Regions regions;
    bool small = true;
    for (std::size_t n = 0; n < regions.size(); ++n) {
      const DexelField* field = sculpture.field(kAxes[n]);
      if (field == nullptr) continue;
      regions[n] = tiles_through(field->grid(), box.lo_mm, box.hi_mm);
      small = small && regions[n].count() <= kTilesMost;
    }
    if (small) return regions;
  }
  return std::nullopt;
}

std::vector<StockFeed::Lacking> StockFeed::lacking(const Sculpture& sculpture, const Regions& near,
                                                   Vec3 tip_mm) const {
  std::vector<Lacking> list;
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
  std::ranges::sort(list, {}, &Lacking::distance_mm);
  return list;
}

/// Adds a tile to the news, if there is anything to say of it.
bool StockFeed::tell(const DexelField& field, FieldTile at, StockUpdate& news) {
  const auto [known, is_new] = known_.try_emplace(at);
  stale_.erase(at);
  const DexelTile* tile = field.find(at.tile);
  std::vector<std::byte> columns;
  if (tile != nullptr) {
    columns = encode_columns(*tile, known->second.get());
    known->second = std::make_unique<DexelTile>(*tile);
    known->second->topmost_codes = {};  // normals are not sent
    known->second->lower_codes = {};
  }
  if (columns.empty() && !is_new) return false;
  news.tiles.push_back({at, std::move(columns)});
  return true;
}

void StockFeed::forget_far(const Regions& near) {
  for (auto& [at, sent] : known_) {
    const auto n = std::size_t(std::ranges::find(kAxes, at.axis) - std::begin(kAxes));
    if (!near[n].has(at.tile)) sent.reset();
  }
}

std::optional<StockUpdate> StockFeed::next(const Sculpture& sculpture, const ToolWatch& watch) {
  if (under_way_.size() >= wire::kStockFramesInFlight ||
      bytes_under_way_ >= wire::kStockBytesInFlight) {
    return std::nullopt;
  }
  const auto near = reach(sculpture, watch);
  if (!near) return std::nullopt;
  StockUpdate news;
  news.reset = reset_;
  news.agent_time_us = watch.time_us;
  std::size_t bytes = 0, looked_at = 0;
  const std::vector<Lacking> list = lacking(sculpture, *near, watch.pose.tip_mm);
  for (const Lacking& one : list) {
    if (bytes >= kPatchBytes || news.tiles.size() == wire::kMaxStockTiles) break;
    if (tell(*sculpture.field(one.at.axis), one.at, news)) {
      bytes += news.tiles.back().columns.size();
    }
    ++looked_at;
  }
  if (looked_at == list.size()) complete_ = *near;
  if (news.tiles.empty() && !reset_) return std::nullopt;
  reset_ = false;
  news.sequence = ++sent_;
  under_way_.push_back(bytes);
  bytes_under_way_ += bytes;
  if (sent_ % kForgetEvery == 0) forget_far(*near);
  return news;
}

bool StockFeed::ack(std::uint64_t sequence) {
  if (sequence > sent_) return false;
  while (!under_way_.empty() && sent_ - under_way_.size() < sequence) {
    bytes_under_way_ -= under_way_.front();
    under_way_.pop_front();
  }
  return true;
}

}  // namespace kerf
