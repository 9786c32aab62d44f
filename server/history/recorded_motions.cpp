// SPDX-License-Identifier: Apache-2.0
#include "server/history/recorded_motions.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "kernel/sculpture_motion.h"
#include "server/store/journal_file.h"
#include "server/store/record_rows.h"

namespace kerf {

namespace {

/// Opens a journal for one transaction.
std::expected<SqlDatabase, std::string> begin_reading(const std::filesystem::path& file,
                                                      const std::stop_token& stop) {
  auto database = open_journal(file, SqlMode::kRead);
  if (!database) return std::unexpected(describe(database.error()));
  if (stop.stop_possible()) database->end_on(stop);
  if (auto begun = database->execute("BEGIN"); !begun) {
    return std::unexpected(begun.error().reason);
  }
  return *std::move(database);
}

}  // namespace

/// Calls `visit` with the records from … until, as far as there are any.
std::expected<void, std::string> RecordedMotions::read(
    SqlDatabase& database, std::uint64_t from, std::uint64_t until, const std::stop_token& stop,
    const std::function<void(JournalRecord&)>& visit) const {
  auto rows = RecordRows::open(file_, database, from);
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
  return {&defined->tool, strokes_.stroke_of(record.participant, record.sequence),
          kerf::motion_of(*move, defined->tool)};
}

std::expected<void, std::string> RecordedMotions::catch_up(
    const std::function<void(std::uint64_t, const RecordedMotion&)>& visit,
    const std::stop_token& stop) {
  const std::uint64_t from = strokes_.last() + 1;
  // The newest window is not complete: it is read again when it is asked for.
  windows_.erase(window_begin(from));
  std::erase(newest_, window_begin(from));
  std::shared_ptr<Window> window;
  auto database = begin_reading(file_, stop);
  if (!database) return std::unexpected(database.error());
  constexpr auto kAll = std::numeric_limits<std::uint64_t>::max();
  auto ok = read(*database, from, kAll, stop, [&](JournalRecord& record) {
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

/// Reads windows from the file; neighbors together, because a reader begins some records earlier.
std::expected<void, std::string> RecordedMotions::read_windows(
    std::span<const std::uint64_t> firsts, Windows& windows, const std::stop_token& stop) {
  auto database = begin_reading(file_, stop);
  if (!database) return std::unexpected(database.error());
  for (std::size_t n = 0; n < firsts.size();) {
    std::size_t end = n + 1;
    while (end < firsts.size() && firsts[end] == firsts[end - 1] + kWindow) ++end;
    std::vector<std::shared_ptr<Window>> run;
    for (; n < end; ++n) run.push_back(std::make_shared<Window>(Window{firsts[n], {}}));
    const std::uint64_t first = run.front()->first;
    const std::uint64_t last = std::min(run.back()->first + kWindow - 1, strokes_.last());
    auto ok = read(*database, first, last, stop, [&](JournalRecord& each) {
      run[(each.sequence - first) / kWindow]->motions.push_back(motion_of(each));
    });
    if (!ok) return std::unexpected(ok.error());
    for (auto& window : run) {
      windows.push_back(window);
      keep(std::move(window));
    }
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
