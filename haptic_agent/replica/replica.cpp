// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/replica/replica.h"

#include <algorithm>
#include <utility>

#include "kernel/dexel/dexel_field.h"
#include "kernel/tool/tool_bounds.h"
#include "server/convert/stock_columns.h"

namespace kerf::agent {
namespace {

constexpr RayAxis kAxes[] = {RayAxis::kZ, RayAxis::kX, RayAxis::kY};

}  // namespace

Replica::Replica(BlockSource source) : source_(std::move(source)), block_(source_.make()) {}

bool Replica::knows(const DexelField& field, std::size_t n, const TileRegion& region) {
  const TileRegion& before = known_region_[n];
  const bool all = region.all_of([&](TileIndex tile) {
    return before.has(tile) || known_.contains({field.grid().axis, tile});
  });
  if (all) known_region_[n] = region;
  return all;
}

/// Whether every tile that the tool may touch on this way is known.
bool Replica::knows(const MoveTool& motion) {
  const Tool& tool = *block_.tool(motion.tool);
  const Bounds box = joined(tool_bounds(tool, motion.from), tool_bounds(tool, motion.to));
  for (std::size_t n = 0; n < std::size(kAxes); ++n) {
    const DexelField* field = block_.field(kAxes[n]);
    if (field == nullptr) continue;
    if (!knows(*field, n, tiles_through(field->grid(), box.lo_mm, box.hi_mm))) return false;
  }
  return true;
}

/// Whether the force of this motion holds nothing of what was not known.
bool Replica::settles(const MoveTool& motion, bool known) {
  if (!known) {
    unsettled_mm_ = 2 * block_.settings().pitch_mm;
  } else if (unsettled_mm_ > 0) {
    const double length_mm = block_.tool(motion.tool)->length_mm;
    unsettled_mm_ -= std::max(length(motion.to.tip_mm - motion.from.tip_mm),
                              length(motion.to.axis - motion.from.axis) * length_mm);
  }
  return known && unsettled_mm_ <= 0;
}

std::optional<wire::Result> Replica::move(const wire::MotionSample& sample) {
  auto step = track_.take(sample, block_, source_.speed_max_mm_per_s());
  if (!step) return std::nullopt;  // the server will say why
  const ToolPose& pose = *track_.pose();
  BatchSum sum;
  bool known = false;
  if (auto* move = std::get_if<MoveTool>(&*step)) {
    known = knows(*move);
    // What is cut of stock that may not be there is not felt, later on neither.
    move->feel = known;
    const auto result = block_.apply(*move);
    if (!result) return std::nullopt;
    cuts_.push_back({sample.time_us, *move});
    while (cuts_.front().time_us + kRememberedUs < sample.time_us) cuts_.pop_front();
    known = settles(*move, known);
    if (known) add_motion(sum, block_, *move, *result);
  } else {
    known = knows(MoveTool{sample.tool_id, pose, pose});
    const auto* touch = std::get_if<ToolTrack::Touch>(&*step);
    if (known && touch != nullptr) add_touch(sum, block_, *touch);
  }
  if (!known) return std::nullopt;
  wire::Result mine;
  mine.agent_time_us = sample.time_us;
  sum.write(mine);
  agreement_.note(mine);
  return mine;
}

/// The server's tiles do not hold yet what the tool has cut since.
void Replica::cut_again(std::uint64_t server_has_us) {
  for (const Cut& cut : cuts_) {
    if (cut.time_us <= server_has_us) continue;
    MoveTool again = cut.move;
    again.feel = knows(again);
    block_.apply(again).value();  // it was applied before: nothing can be wrong with it
  }
}

std::expected<void, std::string_view> Replica::take_tile(const wire::StockTile& tile) {
  const FieldTile at{static_cast<RayAxis>(tile.axis),
                     {static_cast<std::int32_t>(tile.x), static_cast<std::int32_t>(tile.y)}};
  const DexelField* field = block_.field(at.axis);
  if (field == nullptr || !field->grid().has(at.tile)) {
    return std::unexpected("a tile is not in the block");
  }
  const auto columns = decode_columns(tile.columns);
  if (!columns) return std::unexpected(columns.error());
  block_.keep_common(at, *columns);
  known_.insert(at);
  return {};
}

std::expected<void, std::string_view> Replica::take(const wire::StockPatch& patch) {
  if (patch.reset) {
    block_ = source_.make();
    known_.clear();
    known_region_ = {};
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
