// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/files/log_past.h"

#include <utility>

#include "kernel/cut/workers.h"

namespace kerf::page {
namespace {

using Tiles = std::expected<std::optional<std::vector<TileReplacement>>, std::string>;

/// What the history of a page keeps: half of what a server does.
constexpr HistoryMemory kMemory{.windows = 64, .tile_bytes = std::size_t{128} << 20U};

}  // namespace

LogPast::LogPast(std::shared_ptr<const Scene> scene, std::shared_ptr<const RecordLog> log)
    : scene_(std::move(scene)), log_(std::move(log)) {}

std::map<ToolId, Tool> LogPast::tools() {
  std::map<ToolId, Tool> tools = tools_of(*scene_);
  if (history_) tools.merge(history_->tools());
  return tools;
}

Tiles LogPast::tiles_at(std::uint64_t record, const std::stop_token& stop) {
  if (record > log_->last()) return std::nullopt;
  if (auto read = read_history(stop); !read) return std::unexpected(read.error());
  SerialWorkers alone;
  return history_->carve(history_->tiles(), history_->strokes().at(record), alone, stop);
}

Tiles LogPast::tiles_after(const SolidSnapshot& solid, const StrokeSet& changed,
                           std::uint64_t record, const std::stop_token& stop) {
  if (auto read = read_history(stop); !read) return std::unexpected(read.error());
  const auto reached = history_->reach(changed, stop);
  if (!reached) return std::unexpected(reached.error());
  SerialWorkers alone;
  return history_->change(solid, *reached, changed, history_->strokes().at(record), alone, stop);
}

std::expected<std::int64_t, std::string> LogPast::time_of(std::uint64_t record) {
  return log_->time_of(record);
}

std::expected<std::vector<JournalRecord>, std::string> LogPast::records_after(
    std::uint64_t record, std::size_t count, const std::stop_token& /*stop*/) {
  std::vector<JournalRecord> records;
  const RecordRange next{record + 1, record + count};
  const auto add = [&](JournalRecord& each) { records.push_back(std::move(each)); };
  if (auto read = log_->read({&next, 1}, add); !read) return std::unexpected(read.error());
  return records;
}

std::expected<const StrokeTable*, std::string> LogPast::strokes() {
  if (auto read = read_history({}); !read) return std::unexpected(read.error());
  return &history_->strokes();
}

std::expected<void, std::string> LogPast::read_history(const std::stop_token& stop) {
  if (!history_) {
    auto untouched = Sculpture::create(scene_->settings);
    if (!untouched) return std::unexpected(untouched.error().reason);
    history_.emplace(log_records(log_), scene_->settings, untouched->solid(), kMemory);
  }
  return history_->catch_up(stop);
}

}  // namespace kerf::page
