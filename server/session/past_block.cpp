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

}  // namespace

PastBlock::PastBlock(std::unique_ptr<PastSource> source, Sculpture block)
    : source_(std::move(source)), block_(std::move(block)) {}

std::expected<PastBlock, std::string> PastBlock::create(std::unique_ptr<PastSource> source) {
  auto block = Sculpture::create(source->scene().settings);
  if (!block) return std::unexpected(block.error().reason);
  for (const auto& [id, tool] : source->scene().tools) {
    if (auto ok = block->apply(DefineTool{id, tool.tool}); !ok) {
      return std::unexpected(ok.error().reason);
    }
  }
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
  const ReplacedTiles replaced = block_.replace(**tiles);
  changed_.insert(changed_.end(), replaced.changed_tiles.begin(), replaced.changed_tiles.end());
  record_ = record;
  time_ms_ = *time;
  return true;
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
  const auto result = block_.apply(*command);
  if (!result) return std::unexpected(result.error().reason);
  record_ = record.sequence;
  time_ms_ = record.wall_ms;
  changed_.insert(changed_.end(), result->changed_tiles.begin(), result->changed_tiles.end());
  if (move != nullptr) show(record, *move, *result);
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
