// SPDX-License-Identifier: Apache-2.0
#include "server/session/past_block.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/platform/clock.h"

namespace kerf {
namespace {

/// Number of records read at a time.
constexpr std::size_t kAhead = 4096;

/// Defines the tools that a block does not have.
std::expected<void, std::string> define_tools(const std::map<ToolId, Tool>& tools,
                                              Sculpture& block) {
  for (const auto& [id, tool] : tools) {
    if (block.tool(id) != nullptr) continue;
    if (auto ok = block.apply(DefineTool{id, tool}); !ok) return std::unexpected(ok.error().reason);
  }
  return {};
}

/// Returns the block of a scene before its first record, with its tools.
std::expected<Sculpture, std::string> untouched_block(const Scene& scene) {
  auto block = Sculpture::create(scene.settings);
  if (!block) return std::unexpected(block.error().reason);
  if (auto ok = define_tools(tools_of(scene), *block); !ok) return std::unexpected(ok.error());
  return *std::move(block);
}

std::vector<TileIndex> all_tiles(const DexelGrid& grid) {
  std::vector<TileIndex> tiles;
  for (int x = 0; x < grid.tiles_x(); ++x) {
    for (int y = 0; y < grid.tiles_y(); ++y) tiles.push_back({x, y});
  }
  return tiles;
}

}  // namespace

PastBlock::PastBlock(std::unique_ptr<PastSource> source, Sculpture block)
    : source_(std::move(source)), block_(std::move(block)) {}

std::expected<PastBlock, std::string> PastBlock::create(std::unique_ptr<PastSource> source) {
  auto block = untouched_block(*source->scene());
  if (!block) return std::unexpected(block.error());
  return PastBlock(std::move(source), *std::move(block));
}

std::expected<bool, std::string> PastBlock::seek(std::uint64_t record,
                                                 const std::stop_token& stop) {
  const auto found = take(record, source_->tiles_at(record, stop));
  if (!found || !*found) return found;
  ahead_.clear();
  tools_.tools.clear();
  return true;
}

/// Moves the block to the state after a record, given its tiles.
std::expected<bool, std::string> PastBlock::take(std::uint64_t record, const Tiles& tiles) {
  if (!tiles) return std::unexpected(tiles.error());
  if (!*tiles) return false;
  const auto time = source_->time_of(record);
  if (!time) return std::unexpected(time.error());
  if (auto ok = replace(**tiles); !ok) return std::unexpected(ok.error());
  // The records that were skipped may have defined tools.
  if (auto ok = define_tools(source_->tools(), block_); !ok) return std::unexpected(ok.error());
  record_ = record;
  time_ms_ = *time;
  is_torn_ = false;
  return true;
}

/// Replaces tiles of the block, or all of a torn block, given its tiles.
std::expected<void, std::string> PastBlock::replace(std::span<const TileReplacement> tiles) {
  const bool was_torn = std::exchange(is_torn_, true);
  if (was_torn) {
    auto untouched = untouched_block(*source_->scene());
    if (!untouched) return std::unexpected(untouched.error());
    block_ = *std::move(untouched);
  }
  std::vector<TileIndex> changed = block_.replace(tiles).changed_tiles;
  if (was_torn) changed = all_tiles(block_.grid());
  changed_.insert(changed_.end(), changed.begin(), changed.end());
  return {};
}

std::expected<void, std::string> PastBlock::read_ahead(const std::stop_token& stop) {
  auto records = source_->records_after(record_, kAhead, stop);
  if (!records) return std::unexpected(records.error());
  std::ranges::move(*records, std::back_inserter(ahead_));
  return {};
}

std::expected<PastBlock::Played, std::string> PastBlock::play(const PlayUntil& until,
                                                              std::chrono::microseconds budget,
                                                              const std::stop_token& stop) {
  const auto end = Clock::now() + budget;
  Played played;
  if (is_torn_) {
    if (auto mended = seek(record_, stop); !mended) return std::unexpected(mended.error());
  }
  // Records that could not be applied are read again.
  if (!ahead_.empty() && ahead_.front().sequence != record_ + 1) ahead_.clear();
  for (;;) {
    if (ahead_.empty()) {
      if (auto ok = read_ahead(stop); !ok) return std::unexpected(ok.error());
      if (ahead_.empty()) return played;
    }
    played.next_ms = ahead_.front().wall_ms;
    if (!until.covers(ahead_.front())) return played;
    if (stop.stop_requested()) return std::unexpected("stopped");
    if (Clock::now() >= end) {
      played.is_late = true;
      return played;
    }
    const JournalRecord record = std::move(ahead_.front());
    ahead_.pop_front();
    if (auto ok = apply(record, until, stop); !ok) return std::unexpected(ok.error());
    played.next_ms = 0;
  }
}

/// In a run of changes, all that are due are applied with the last one.
std::expected<void, std::string> PastBlock::change(const JournalRecord& record,
                                                   const PlayUntil& until,
                                                   const std::stop_token& stop) {
  std::uint64_t last = record.sequence;
  StrokeSet changed{std::get<StrokeChange>(record.command).stroke};
  while (!ahead_.empty() && until.covers(ahead_.front())) {
    const auto* next = std::get_if<StrokeChange>(&ahead_.front().command);
    if (next == nullptr) break;
    last = ahead_.front().sequence;
    changed.insert(next->stroke);
    ahead_.pop_front();
  }
  const auto done = take(last, source_->tiles_after(block_.solid(), changed, last, stop));
  if (!done) return std::unexpected(done.error());
  return {};
}

std::expected<void, std::string> PastBlock::apply(const JournalRecord& record,
                                                  const PlayUntil& until,
                                                  const std::stop_token& stop) {
  if (std::holds_alternative<StrokeChange>(record.command)) return change(record, until, stop);
  auto command = kernel_command(record.command);
  auto* move = std::get_if<MoveTool>(&*command);
  if (move != nullptr) move->feel = until.feels;
  is_torn_ = true;
  const auto result = block_.apply(*command);
  if (!result) return std::unexpected(result.error().reason);
  changed_.insert(changed_.end(), result->changed_tiles.begin(), result->changed_tiles.end());
  if (move != nullptr) show(record, *move, *result);
  record_ = record.sequence;
  time_ms_ = record.wall_ms;
  is_torn_ = false;
  return {};
}

void PastBlock::show(const JournalRecord& record, const MoveTool& move,
                     const MotionResult& result) {
  auto& tools = tools_.tools;
  auto tool = std::ranges::find(tools, record.participant, &wire::ToolState::participant);
  if (tool == tools.end()) {
    if (tools.size() == wire::kMaxToolStates) return;
    tool = tools.insert(tools.end(), {.participant = record.participant});
  }
  tool->tool_id = move.tool;
  tool->tip_mm = move.to.tip_mm;
  tool->axis = Vec3f(move.to.axis);
  tool->status = result.removed_mm3 > 0 ? wire::kStatusCutting : 0;
  tool->force_n = Vec3f(result.wrench.force_n);
  tool->torque_nmm = Vec3f(result.wrench.torque_nmm);
  tool->removed_rate_mm3_per_s =
      move.duration_s > 0 ? static_cast<float>(result.removed_mm3 / move.duration_s) : 0.0F;
}

std::vector<TileIndex> PastBlock::take_changed() { return std::exchange(changed_, {}); }

}  // namespace kerf
