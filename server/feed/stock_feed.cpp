#include "server/feed/stock_feed.h"

#include <algorithm>
#include <cmath>

#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/tile_region.h"
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

wire::StockPatch StockNews::patch() const {
  wire::StockPatch patch;
  patch.afresh = afresh;
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
    const auto known = known_.find(tile);
    if (known != known_.end()) known->second.stale = true;
  }
}

void StockFeed::start_afresh() {
  known_.clear();
  afresh_ = true;
}

/// What the tool may reach before the next patches arrive.
Bounds StockFeed::reach(const ToolWatch& watch) {
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
  return grown(joined(tool_bounds(watch.tool, watch.pose), tool_bounds(watch.tool, later)),
               kReachMm);
}

void StockFeed::collect(const DexelField& field, const Bounds& near, Vec3 tip_mm,
                        std::vector<Lacking>& lacking) const {
  const DexelGrid& grid = field.grid();
  const Vec3 tip = to_frame(grid.axis, tip_mm);
  constexpr double kHalf = kTileSide / 2.0;
  tiles_through(grid, near.lo_mm, near.hi_mm).all_of([&](TileIndex tile) {
    const FieldTile at{grid.axis, tile};
    const auto known = known_.find(at);
    if (known != known_.end() && !known->second.stale) return true;
    const double x = grid.origin_mm.x + (tile.x * kTileSide + kHalf) * grid.pitch_mm - tip.x;
    const double y = grid.origin_mm.y + (tile.y * kTileSide + kHalf) * grid.pitch_mm - tip.y;
    lacking.push_back({std::hypot(x, y), at});
    return true;
  });
}

/// Adds a tile to the news, if there is anything to say of it.
bool StockFeed::tell(const DexelField& field, FieldTile at, StockNews& news) {
  const auto [place, is_new] = known_.try_emplace(at);
  Known& known = place->second;
  known.stale = false;
  const DexelTile* tile = field.find(at.tile);
  std::vector<std::byte> columns;
  if (tile != nullptr) {
    columns = encode_columns(*tile, known.sent.get());
    known.sent = std::make_unique<DexelTile>(*tile);
    known.sent->topmost_codes = {};  // normals are not sent
    known.sent->lower_codes = {};
  }
  if (columns.empty() && !is_new) return false;
  news.tiles.push_back({at, std::move(columns)});
  return true;
}

void StockFeed::forget_far(const Sculpture& sculpture, const Bounds& near) {
  for (auto& [at, known] : known_) {
    const TileRegion region =
        tiles_through(sculpture.field(at.axis)->grid(), near.lo_mm, near.hi_mm);
    if (!region.has(at.tile)) known.sent.reset();
  }
}

std::optional<StockNews> StockFeed::next(const Sculpture& sculpture, const ToolWatch& watch) {
  if (under_way_.size() >= wire::kStockFramesInFlight ||
      bytes_under_way_ >= wire::kStockBytesInFlight) {
    return std::nullopt;
  }
  const Bounds near = reach(watch);
  std::vector<Lacking> lacking;
  for (const RayAxis axis : kAxes) {
    if (const DexelField* field = sculpture.field(axis)) {
      collect(*field, near, watch.pose.tip_mm, lacking);
    }
  }
  if (lacking.empty() && !afresh_) return std::nullopt;
  std::ranges::sort(lacking, {}, &Lacking::distance_mm);
  StockNews news;
  news.afresh = afresh_;
  news.agent_time_us = watch.time_us;
  std::size_t bytes = 0;
  for (const Lacking& one : lacking) {
    if (bytes >= kPatchBytes || news.tiles.size() == wire::kMaxStockTiles) break;
    if (tell(*sculpture.field(one.at.axis), one.at, news))
      bytes += news.tiles.back().columns.size();
  }
  if (news.tiles.empty() && !afresh_) return std::nullopt;
  afresh_ = false;
  news.sequence = ++sent_;
  under_way_.push_back(bytes);
  bytes_under_way_ += bytes;
  if (sent_ % kForgetEvery == 0) forget_far(sculpture, near);
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
