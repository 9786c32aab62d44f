#include "haptic_agent/replica/replica.h"

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
  if (known_region_[n] == region) return true;
  const bool all = region.all_of(
      [&](TileIndex tile) { return known_.contains(FieldTile{field.grid().axis, tile}); });
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

std::optional<wire::Result> Replica::move(const wire::MotionSample& sample) {
  const auto step = track_.take(sample, block_, source_.speed_max_mm_per_s());
  if (!step) return std::nullopt;  // the server will say why
  const ToolPose& pose = *track_.pose();
  BatchSum sum;
  bool known = false;
  if (const auto* move = std::get_if<MoveTool>(&*step)) {
    known = knows(*move);
    const auto result = block_.apply(*move);
    if (!result) return std::nullopt;
    cuts_.push_back({sample.time_us, *move});
    while (cuts_.front().time_us + kRememberedUs < sample.time_us) cuts_.pop_front();
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

void Replica::begin_afresh(std::uint64_t server_has_us) {
  block_ = source_.make();
  known_.clear();
  known_region_ = {};
  for (const Cut& cut : cuts_) {
    MoveTool again = cut.move;
    again.feel = false;
    // It was applied before: nothing can be wrong with it.
    if (cut.time_us > server_has_us) block_.apply(again).value();
  }
}

std::expected<void, std::string_view> Replica::take(const wire::StockPatch& patch) {
  if (patch.afresh) begin_afresh(patch.agent_time_us);
  for (const wire::StockTile& tile : patch.tiles) {
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
  }
  return {};
}

void Replica::compare(const wire::Result& theirs) { agreement_.compare(theirs); }

}  // namespace kerf::agent
