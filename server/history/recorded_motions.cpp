// SPDX-License-Identifier: Apache-2.0
#include "server/history/recorded_motions.h"

#include <algorithm>
#include <utility>

#include "kernel/sculpture_motion.h"

namespace kerf {

RecordedMotion RecordedMotions::motion_of(const JournalRecord& record) const {
  const auto* move = std::get_if<MoveTool>(&record.command);
  if (move == nullptr) return {};
  const auto defined = std::find_if(tools_.rbegin(), tools_.rend(), [&](const DefinedTool& tool) {
    return tool.id == move->tool && tool.record < record.sequence;
  });
  if (defined == tools_.rend()) return {};
  return {&defined->tool, strokes_.stroke_of(record.participant, record.sequence),
          kerf::motion_of(*move, defined->tool)};
}

std::map<ToolId, Tool> RecordedMotions::tools() const {
  std::map<ToolId, Tool> tools;
  for (const DefinedTool& defined : tools_) tools.insert_or_assign(defined.id, defined.tool);
  return tools;
}

std::expected<void, std::string> RecordedMotions::catch_up(
    const std::function<void(std::uint64_t, const RecordedMotion&)>& visit,
    const std::stop_token& stop) {
  const std::uint64_t from = strokes_.last() + 1;
  // The newest window is incomplete, so it is read again on demand.
  windows_.erase(window_begin(from));
  std::erase(newest_, window_begin(from));
  std::shared_ptr<Window> window;
  const RecordRange all{.first = from};
  const auto add = [&](JournalRecord& record) {
    strokes_.add(record);
    if (const auto* define = std::get_if<DefineTool>(&record.command)) {
      tools_.push_back({record.sequence, define->id, define->tool});
    }
    const RecordedMotion motion = motion_of(record);
    const std::uint64_t first = window_begin(record.sequence);
    if (record.sequence == first) window = std::make_shared<Window>(Window{first, {}});
    if (window) window->motions.push_back(motion);
    if (window && window->motions.size() == kWindow) keep(std::exchange(window, nullptr));
    if (motion.tool != nullptr) visit(record.sequence, motion);
  };
  auto ok = journal_->read({&all, 1}, add, stop);
  if (ok && window) keep(std::move(window));
  return ok;
}

std::expected<RecordedMotions::Windows, std::string> RecordedMotions::windows(
    std::span<const std::uint64_t> firsts, const std::stop_token& stop) {
  if (stop.stop_requested()) return std::unexpected("stopped");
  Windows windows;
  std::vector<std::uint64_t> absent;
  for (const std::uint64_t first : firsts) {
    const auto found = windows_.find(first);
    windows.push_back(found == windows_.end() ? nullptr : found->second);
    if (!windows.back()) {
      absent.push_back(first);
      continue;
    }
    std::erase(newest_, first);
    newest_.push_back(first);
  }
  if (absent.empty()) return windows;
  Windows read;
  if (auto ok = read_windows(absent, read, stop); !ok) return std::unexpected(ok.error());
  auto next = read.begin();
  for (auto& window : windows) {
    if (!window) window = *next++;
  }
  return windows;
}

/// Reads windows, neighbors together, because a reader begins some records earlier.
std::expected<void, std::string> RecordedMotions::read_windows(
    std::span<const std::uint64_t> firsts, Windows& windows, const std::stop_token& stop) {
  std::vector<RecordRange> ranges;
  std::map<std::uint64_t, std::shared_ptr<Window>> read;
  for (const std::uint64_t first : firsts) {
    read.emplace(first, std::make_shared<Window>(Window{first, {}}));
    if (ranges.empty() || ranges.back().last + 1 != first) ranges.push_back({first, first});
    ranges.back().last = std::min(first + kWindow - 1, strokes_.last());
  }
  const auto add = [&](JournalRecord& record) {
    Window& window = *read.at(window_begin(record.sequence));
    window.motions.resize(record.sequence - window.first);  // a salvaged journal begins anywhere
    window.motions.push_back(motion_of(record));
  };
  if (auto ok = journal_->read(ranges, add, stop); !ok) return ok;
  for (const std::uint64_t first : firsts) {
    windows.push_back(read.at(first));
    keep(read.at(first));
  }
  return {};
}

void RecordedMotions::keep(std::shared_ptr<const Window> window) {
  newest_.push_back(window->first);
  windows_[window->first] = std::move(window);
  if (newest_.size() <= windows_kept_) return;
  windows_.erase(newest_.front());
  newest_.pop_front();
}

}  // namespace kerf
