// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/replica/replica.h"

#include <algorithm>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/estimated_normals.h"
#include "kernel/dexel/stock_column.h"
#include "kernel/motion_reach.h"
#include "kernel/sculpture_check.h"
#include "kernel/tool/tool_bounds.h"
#include "server/convert/stock_columns.h"

namespace kerf::agent {
namespace {

/// Applies a motion that another copy of the block has accepted.
void cut_unfelt(Sculpture& block, MoveTool move) {
  move.feel = false;
  block.apply(move).value();
}

constexpr RayAxis kAxes[] = {RayAxis::kZ, RayAxis::kX, RayAxis::kY};

FieldTile place_of(const wire::StockTile& tile) {
  return {static_cast<RayAxis>(tile.axis),
          {static_cast<std::int32_t>(tile.x), static_cast<std::int32_t>(tile.y)}};
}

}  // namespace

Replica::Replica(BlockSource source)
    : source_(std::move(source)), block_(source_.make()), others_(block_.settings().pitch_mm) {}

std::expected<void, std::string> Replica::define_tools(std::string_view message) {
  const auto added = source_.add_tools(message);
  if (!added) return std::unexpected(added.error());
  for (const auto& [id, tool] : *added) {
    const DefineTool define{id, tool};
    block_.apply(define).value();
    if (stock_) stock_->apply(define).value();
  }
  return {};
}

bool Replica::is_known(const DexelField& field, std::size_t n, const TileRegion& region) {
  const TileRegion& before = known_region_[n];
  const bool all = region.all_of([&](TileIndex tile) {
    return before.has(tile) || known_.contains({field.grid().axis, tile});
  });
  if (all) known_region_[n] = region;
  return all;
}

/// Returns whether every tile that the tool may touch in this motion is known.
bool Replica::is_known(const MoveTool& motion) {
  const Tool& tool = *block_.tool(motion.tool);
  const Bounds box = joined(tool_bounds(tool, motion.from), tool_bounds(tool, motion.to));
  for (std::size_t n = 0; n < std::size(kAxes); ++n) {
    const DexelField* field = block_.field(kAxes[n]);
    if (field == nullptr) continue;
    if (!is_known(*field, n, tiles_through(field->grid(), box.lo_mm, box.hi_mm))) return false;
  }
  return true;
}

bool Replica::knows_around(TileIndex tile) const {
  const DexelGrid& grid = block().grid();
  const double side_mm = kTileSide * grid.pitch_mm, pitch_mm = grid.pitch_mm;
  const Vec3 corner_mm = grid.origin_mm + Vec3{tile.x * side_mm, tile.y * side_mm, 0};
  const Vec3 lo_mm = corner_mm - Vec3{pitch_mm, pitch_mm, 0};
  const Vec3 hi_mm = corner_mm + Vec3{side_mm + pitch_mm, side_mm + pitch_mm,
                                      grid.z_mm(grid.height_quanta) - grid.origin_mm.z};
  return std::ranges::all_of(axes_of(block().settings().rays), [&](RayAxis axis) {
    return tiles_through(block().field(axis)->grid(), lo_mm, hi_mm).all_of([&](TileIndex at) {
      return known_.contains({axis, at});
    });
  });
}

/// Returns whether the force of this motion is independent of unknown stock.
bool Replica::is_settled(const MoveTool& motion, bool known) {
  if (!known) {
    unsettled_mm_ = settling_mm();
  } else if (unsettled_mm_ > 0) {
    const double length_mm = block_.tool(motion.tool)->length_mm;
    unsettled_mm_ -= std::max(length(motion.to.tip_mm - motion.from.tip_mm),
                              length(motion.to.axis - motion.from.axis) * length_mm);
  }
  return known && unsettled_mm_ <= 0;
}

/// Returns the tool in the motion to this sample. The force also depends on the stock around it and
/// along the last two pitches of travel.
OtherTools::Own Replica::own_tool(const wire::MotionSample& sample) const {
  const ToolPose to{sample.tip_mm, normalized(Vec3(sample.axis))};
  const ToolPose from = track_.pose().value_or(to);
  Bounds box = joined({from.tip_mm, from.tip_mm}, {to.tip_mm, to.tip_mm});
  if (const Tool* tool = block_.tool(sample.tool_id)) {
    box = joined(tool_bounds(*tool, from), tool_bounds(*tool, to));
  }
  return {to.tip_mm, grown(box, 2 * block_.settings().pitch_mm)};
}

/// Makes block_ equal to stock_ less the expected cuts of other tools near this one until now.
void Replica::look_ahead(const wire::MotionSample& sample) {
  const std::uint64_t now_us = sample.time_us;
  if (!others_.are_near(now_us)) {
    if (stock_) block_.restore(stock_->solid());
    stock_.reset();
    return;
  }
  const OtherTools::Own own = own_tool(sample);
  if (!stock_) {
    stock_.emplace(source_.make());
    stock_->restore(block_.solid());
    others_.restart(now_us, own);
  } else if (others_.are_off(now_us, own)) {
    block_.restore(stock_->solid());
    others_.restart(now_us, own);
  }
  others_.cut(block_, now_us);
}

std::optional<wire::Result> Replica::move(const wire::MotionSample& sample) {
  const auto result = answer(sample);
  if (result) {
    agreement_.note(*result);
  } else {
    agreement_.note_missing();
  }
  return result;
}

Sculpture Replica::copy() {
  Sculpture block = source_.make();
  block.restore(solid());
  return block;
}

std::optional<wire::Result> Replica::answer(const wire::MotionSample& sample) {
  newest_cut_.reset();
  look_ahead(sample);
  auto step = track_.take(sample, block_, source_.speed_max_mm_per_s());
  const std::optional<ToolPose>& pose = track_.pose();
  if (!step || !pose) return std::nullopt;  // the server will report the reason
  BatchSum sum;
  bool known = false;
  if (auto* move = std::get_if<MoveTool>(&*step)) {
    known = is_known(*move);
    // Never render the force of cutting stock that may not exist, not even later.
    move->feel = known;
    auto result = block_.apply(*move);
    if (!result) return std::nullopt;
    if (stock_) cut_unfelt(*stock_, *move);
    cuts_.push_back({sample.time_us, *move});
    while (cuts_.front().time_us + kRememberedUs < sample.time_us) cuts_.pop_front();
    known = is_settled(*move, known);
    if (known) {
      add_motion(sum, block_, *move, *result, held_);
    } else {
      held_.drop();
    }
    newest_cut_ = NewestCut{*move, *std::move(result)};
  } else {
    known = is_known(MoveTool{sample.tool_id, *pose, *pose});
    if (known) add_rest(sum, block_, *step, held_);
    const auto* touch = std::get_if<ToolTrack::Touch>(&*step);
    if (known && touch != nullptr) add_touch(sum, block_, *touch);
  }
  if (!known) return std::nullopt;
  wire::Result result;
  result.agent_time_us = sample.time_us;
  sum.write(result);
  return result;
}

/// Reapplies the motions that the server's tiles do not contain yet.
void Replica::cut_again(std::uint64_t server_has_us) {
  for (const Cut& cut : cuts_) {
    if (cut.time_us <= server_has_us) continue;
    MoveTool again = cut.move;
    again.feel = is_known(again);
    block_.apply(again).value();  // cannot fail: it was applied before
  }
}

/// Returns the field that contains a tile.
std::expected<const DexelField*, std::string_view> Replica::field_of(FieldTile at) const {
  const DexelField* field = block_.field(at.axis);
  if (field != nullptr && field->grid().has(at.tile)) return field;
  return std::unexpected("the tile is outside the block");
}

std::expected<void, std::string_view> Replica::take_tile(const wire::StockTile& tile) {
  const FieldTile at = place_of(tile);
  if (const auto field = field_of(at); !field) return std::unexpected(field.error());
  const auto columns = decode_columns(tile.columns);
  if (!columns) return std::unexpected(columns.error());
  block_.keep_common(at, *columns);
  if (stock_) stock_->keep_common(at, *columns);
  known_.insert(at);
  return {};
}

/// Forgets the expected cuts and poses of other tools, because the server may have undone their
/// cuts.
void Replica::forget_others() {
  if (stock_) block_.restore(stock_->solid());
  stock_.reset();
  others_.forget();
}

/// Applies tiles to which stock has come back: the server's contents, less this agent's motions
/// that the server did not have yet.
std::expected<void, std::string_view> Replica::take_returned(const wire::StockPatch& patch) {
  std::vector<TileReplacement> tiles;
  for (const wire::StockTile& tile : patch.tiles) {
    const FieldTile at = place_of(tile);
    const auto field = field_of(at);
    if (!field) return std::unexpected(field.error());
    const auto columns = decode_columns(tile.columns);
    if (!columns) return std::unexpected(columns.error());
    tiles.push_back({at, nullptr});
    if (columns->columns.empty()) continue;
    const auto content = std::make_shared<DexelTile>();
    fill_from_stock((*field)->stock(), (*field)->grid(), at.tile, *content);
    const bool keeps_normals = (*field)->keeps_normals();
    if (keeps_normals) content->topmost_codes.resize(kTileColumns);
    keep_common(*content, *columns);
    if (keeps_normals) estimate_normals(*content, at.tile, (*field)->stock(), (*field)->grid());
    tiles.back().tile = content;
  }
  forget_others();
  replace(tiles, patch.agent_time_us);
  known_region_ = {};
  for (const TileReplacement& tile : tiles) {
    if (tile.tile) {
      known_.insert(tile.at);
    } else {
      known_.erase(tile.at);
    }
  }
  return {};
}

/// Replaces tiles in block_ and cuts each with the motions that the server's tiles do not contain
/// yet.
void Replica::replace(std::span<const TileReplacement> tiles, std::uint64_t server_has_us) {
  std::vector<DexelGrid> grids;
  for (const RayAxis axis : axes_of(block_.settings().rays)) {
    grids.push_back(block_.field(axis)->grid());
  }
  std::map<FieldTile, std::vector<MotionSince>> since;
  std::vector<FieldTile> reach;
  for (const Cut& cut : cuts_) {
    if (cut.time_us <= server_has_us) continue;
    const MotionSince motion{block_.tool(cut.move.tool), cut.move};
    find_reach(*motion.tool, cut.move, grids, block_.settings().tolerance_mm, reach);
    for (const FieldTile& tile : reach) since[tile].push_back(motion);
  }
  for (const TileReplacement& tile : tiles) {
    block_.replace({&tile, 1}, since[tile.at]);
    if (!is_near(tile.at)) continue;
    unsettled_mm_ = settling_mm();
    held_.drop();
  }
}

/// Returns whether the force of the next motion may depend on the cuts in a tile.
bool Replica::is_near(FieldTile at) const {
  const Tool* tool = block_.tool(track_.tool());
  if (tool == nullptr || !track_.pose()) return false;
  const Bounds box = grown(tool_bounds(*tool, *track_.pose()), settling_mm());
  return tiles_through(block_.field(at.axis)->grid(), box.lo_mm, box.hi_mm).has(at.tile);
}

std::expected<void, std::string_view> Replica::take(const wire::StockPatch& patch) {
  if (patch.reset) {
    forget_others();
    block_ = source_.make();
    known_.clear();
    known_region_ = {};
    held_.drop();
  } else if (patch.returned) {
    return take_returned(patch);
  }
  std::expected<void, std::string_view> taken;
  for (const wire::StockTile& tile : patch.tiles) {
    taken = take_tile(tile);
    if (!taken) break;
  }
  if (patch.reset) cut_again(patch.agent_time_us);
  return taken;
}

}  // namespace kerf::agent
