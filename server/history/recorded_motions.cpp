// SPDX-License-Identifier: Apache-2.0
#include "server/history/recorded_motions.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "server/store/journal_file.h"
#include "server/store/record_rows.h"

namespace kerf {

/// Calls `visit` with the records from … until, as far as there are any.
std::expected<void, std::string> RecordedMotions::read(
    std::uint64_t from, std::uint64_t until, const std::stop_token& stop,
    const std::function<void(JournalRecord&)>& visit) const {
  auto database = open_journal(file_, SqlMode::kRead);
  if (!database) return std::unexpected(describe(database.error()));
  if (stop.stop_possible()) database->end_on(stop);
  if (auto begun = database->execute("BEGIN"); !begun) {
    return std::unexpected(begun.error().reason);
  }
  auto rows = RecordRows::open(file_, *database, from);
  if (!rows) return std::unexpected(describe(rows.error()));
  for (;;) {
    if (stop.stop_requested()) return std::unexpected("stopped");
    auto record = rows->next();
    if (!record) return std::unexpected(describe(record.error()));
    if (!*record || (*record)->sequence > until) return {};
    visit(**record);
  }
}

RecordedMotion RecordedMotions::motion_of(const JournalRecord& record) const {
  const auto* move = std::get_if<MoveTool>(&record.command);
  if (move == nullptr) return {};
  const auto defined = std::find_if(tools_.rbegin(), tools_.rend(), [&](const DefinedTool& tool) {
    return tool.id == move->tool && tool.record < record.sequence;
  });
  if (defined == tools_.rend()) return {};
  return {&defined->tool, strokes_.stroke_of(record.participant, record.sequence), *move};
}

std::expected<void, std::string> RecordedMotions::catch_up(
    const std::function<void(std::uint64_t, const RecordedMotion&)>& visit,
    const std::stop_token& stop) {
  const std::uint64_t from = strokes_.last() + 1;
  // The newest window is not complete: it is read again when it is asked for.
  windows_.erase(window_begin(from));
  std::erase(newest_, window_begin(from));
  std::shared_ptr<Window> window;
  auto ok = read(from, std::numeric_limits<std::uint64_t>::max(), stop, [&](JournalRecord& record) {
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
  });
  if (ok && window) keep(std::move(window));
  return ok;
}

std::expected<std::shared_ptr<const RecordedMotions::Window>, std::string> RecordedMotions::window(
    std::uint64_t record, const std::stop_token& stop) {
  const std::uint64_t first = window_begin(record);
  if (const auto found = windows_.find(first); found != windows_.end()) {
    std::erase(newest_, first);
    newest_.push_back(first);
    return found->second;
  }
  auto window = std::make_shared<Window>(Window{first, {}});
  const std::uint64_t last = std::min(first + kWindow - 1, strokes_.last());
  auto ok = read(first, last, stop,
                 [&](JournalRecord& each) { window->motions.push_back(motion_of(each)); });
  if (!ok) return std::unexpected(ok.error());
  keep(window);
  return window;
}

void RecordedMotions::keep(std::shared_ptr<const Window> window) {
  newest_.push_back(window->first);
  windows_[window->first] = std::move(window);
  if (newest_.size() <= windows_kept_) return;
  windows_.erase(newest_.front());
  newest_.pop_front();
}

}  // namespace kerf
