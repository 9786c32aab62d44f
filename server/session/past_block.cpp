// SPDX-License-Identifier: Apache-2.0
#include "server/session/past_block.h"

#include <algorithm>
#include <utility>

#include "kernel/cut/workers.h"
#include "server/session/session.h"
#include "server/store/journal_file.h"
#include "server/store/journal_times.h"
#include "server/store/record_rows.h"

namespace kerf {
namespace {

/// Records that are read at a time.
constexpr std::size_t kAhead = 4096;

}  // namespace

PastBlock::PastBlock(std::shared_ptr<Session> session, Sculpture block)
    : session_(std::move(session)), block_(std::move(block)) {}

std::expected<PastBlock, std::string> PastBlock::create(std::shared_ptr<Session> session) {
  auto block = Sculpture::create(session->scene().settings);
  if (!block) return std::unexpected(block.error().reason);
  for (const auto& [id, tool] : session->scene().tools) {
    if (auto ok = block->apply(DefineTool{id, tool.tool}); !ok) {
      return std::unexpected(ok.error().reason);
    }
  }
  return PastBlock(std::move(session), *std::move(block));
}

std::expected<bool, std::string> PastBlock::seek(std::uint64_t record,
                                                 const std::stop_token& stop) {
  SerialWorkers alone;
  const auto tiles = session_->tiles_at(record, alone, stop);
  if (!tiles) return std::unexpected(tiles.error());
  if (!*tiles) return false;
  const auto time = time_of(session_->journal_file(), record);
  if (!time) return std::unexpected(describe(time.error()));
  const ReplacedTiles replaced = block_.replace(**tiles);
  changed_.insert(changed_.end(), replaced.changed_tiles.begin(), replaced.changed_tiles.end());
  record_ = record;
  time_ms_ = *time;
  ahead_.clear();
  tools_.tools.clear();
  return true;
}

std::expected<void, std::string> PastBlock::read_ahead(const std::stop_token& stop) {
  if (session_->committed() <= record_) return {};
  const std::filesystem::path& file = session_->journal_file();
  auto database = open_journal(file, SqlMode::kRead);
  if (!database) return std::unexpected(describe(database.error()));
  if (stop.stop_possible()) database->end_on(stop);
  // One transaction, so that the last record is that of the rows.
  if (auto ok = database->execute("BEGIN"); !ok) return std::unexpected(ok.error().reason);
  auto rows = RecordRows::open(file, *database, record_ + 1);
  if (!rows) return std::unexpected(describe(rows.error()));
  while (ahead_.size() < kAhead) {
    auto record = rows->next();
    if (!record) return std::unexpected(describe(record.error()));
    if (!*record) break;
    ahead_.push_back(**std::move(record));
  }
  return {};
}

std::expected<PastBlock::Played, std::string> PastBlock::play(std::int64_t until_ms,
                                                              std::chrono::microseconds budget,
                                                              const std::stop_token& stop) {
  const auto end = std::chrono::steady_clock::now() + budget;
  Played played;
  for (;;) {
    if (ahead_.empty()) {
      if (auto ok = read_ahead(stop); !ok) return std::unexpected(ok.error());
      if (ahead_.empty()) return played;
    }
    played.next_ms = ahead_.front().wall_ms;
    if (played.next_ms > until_ms) return played;
    if (stop.stop_requested()) return std::unexpected("stopped");
    if (std::chrono::steady_clock::now() >= end) {
      played.is_late = true;
      return played;
    }
    const JournalRecord record = std::move(ahead_.front());
    ahead_.pop_front();
    if (auto ok = apply(record, until_ms, stop); !ok) return std::unexpected(ok.error());
    played.next_ms = 0;
  }
}

std::expected<void, std::string> PastBlock::apply(const JournalRecord& record,
                                                  std::int64_t until_ms,
                                                  const std::stop_token& stop) {
  if (std::holds_alternative<StrokeChange>(record.command)) {
    // Of several changes in a row, those that follow in time are applied with the last one.
    std::uint64_t last = record.sequence;
    while (!ahead_.empty() && ahead_.front().wall_ms <= until_ms &&
           std::holds_alternative<StrokeChange>(ahead_.front().command)) {
      last = ahead_.front().sequence;
      ahead_.pop_front();
    }
    auto ahead = std::exchange(ahead_, {});
    auto tools = tools_;
    if (auto done = seek(last, stop); !done) return std::unexpected(done.error());
    ahead_ = std::move(ahead);
    tools_ = std::move(tools);
    return {};
  }
  auto command = kernel_command(record.command);
  auto* move = std::get_if<MoveTool>(&*command);
  if (move != nullptr) move->feel = true;
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
