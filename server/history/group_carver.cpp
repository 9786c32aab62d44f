// SPDX-License-Identifier: Apache-2.0
#include "server/history/group_carver.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

namespace kerf {
namespace {

/// Windows read before they are cut: 10 MB.
constexpr std::size_t kWindowsAtOnce = 64;
/// Parts per worker, so that no worker waits long for another.
constexpr int kPartsEach = 3;

/// The jobs of some tiles, in the order of tiles and records, carved by one TileCarver.
class Part {
  static constexpr std::size_t kNone = SIZE_MAX;

 public:
  Part(TileCarver& carver, std::span<GroupJob> jobs) : carver_(carver), jobs_(jobs) {
    for (std::size_t n = 0; n < jobs_.size(); ++n) {
      if (n == 0 || jobs_[n].at != jobs_[n - 1].at) held_.push_back(kNone);
      tile_of_.push_back(held_.size() - 1);
      for (const MotionRun& run : jobs_[n].runs) {
        runs_.push_back({run.stroke, run.first, std::min(run.last, jobs_[n].last), n});
      }
    }
    std::ranges::sort(runs_, {}, &Run::first);
  }

  /// Adds the first records of the windows that it needs.
  void add_windows(std::vector<std::uint64_t>& firsts) const {
    for (const Run& run : runs_) {
      for (auto first = RecordedMotions::window_begin(run.first); first <= run.last;
           first += RecordedMotions::kWindow) {
        if (firsts.empty() || firsts.back() != first) firsts.push_back(first);
      }
    }
  }

  /// Cuts the motions of a window. All needed windows come, in ascending order.
  void cut(const RecordedMotions::Window& window) {
    const std::uint64_t end = window.first + window.motions.size();
    touches_.clear();
    std::vector<Run> runs = std::exchange(continued_, {});
    for (; next_ < runs_.size() && runs_[next_].first < end; ++next_) runs.push_back(runs_[next_]);
    for (const Run& run : runs) {
      const RecordedMotion* before = run.before ? &*run.before : nullptr;
      for (auto record = std::max(run.first, window.first); record < std::min(run.last + 1, end);
           ++record) {
        const RecordedMotion& motion = window.motions[record - window.first];
        if (motion.tool == nullptr || motion.stroke != run.stroke) continue;
        touches_.push_back({record, run.job, std::exchange(before, &motion)});
      }
      if (run.last < end) continue;
      continued_.push_back(run);
      if (before != nullptr) continued_.back().before = *before;
    }
    std::ranges::sort(touches_, {}, [](const Touch& t) { return std::pair(t.record, t.job); });
    for (auto touch = touches_.begin(); touch != touches_.end();) {
      const std::uint64_t record = touch->record;
      tiles_.clear();
      // The previous motion is the same for all tiles whose runs do not begin with this one.
      const RecordedMotion* before = touch->before;
      for (; touch != touches_.end() && touch->record == record; ++touch) {
        hold(touch->job);
        tiles_.push_back(jobs_[touch->job].at);
        if (touch->before == nullptr) before = nullptr;
      }
      const RecordedMotion& motion = window.motions[record - window.first];
      carver_.cut(*motion.tool, motion.motion, tiles_, continues(before, motion));
    }
  }

  /// Takes the tiles that the carver still holds.
  void finish() {
    for (const std::size_t job : held_) take(job);
  }

 private:
  struct Run {
    StrokeId stroke;
    std::uint64_t first, last;
    std::size_t job;
    std::optional<RecordedMotion> before = {};  ///< the last motion cut
  };
  struct Touch {
    std::uint64_t record;
    std::size_t job;
    const RecordedMotion* before;  ///< in its run; null for the first
  };

  void take(std::size_t job) {
    if (job != kNone) jobs_[job].tile = carver_.take(jobs_[job].at);
  }
  /// Before a job cuts its tile, takes the previous job's result there.
  void hold(std::size_t job) {
    std::size_t& held = held_[tile_of_[job]];
    if (held == job) return;
    take(std::exchange(held, job));
    if (jobs_[job].from) carver_.begin(jobs_[job].at, jobs_[job].from);
  }

  TileCarver& carver_;
  std::span<GroupJob> jobs_;
  std::vector<Run> runs_, continued_;
  std::size_t next_ = 0;  ///< in runs_
  std::vector<Touch> touches_;
  std::vector<FieldTile> tiles_;
  std::vector<std::size_t> tile_of_;  ///< of each job, its index in held_
  std::vector<std::size_t> held_;     ///< of each tile, the job that the carver holds
};

/// Divides the jobs into parts of whole tiles with about equal numbers of records.
std::vector<std::span<GroupJob>> divide(std::span<GroupJob> jobs, std::size_t parts) {
  const auto work = [](const GroupJob& job) {
    std::uint64_t records = 1;
    for (const MotionRun& run : job.runs) records += run.last - run.first + 1;
    return records;
  };
  std::uint64_t all = 0, done = 0;
  for (const GroupJob& job : jobs) all += work(job);
  std::vector<std::span<GroupJob>> divided;
  std::size_t begin = 0;
  for (std::size_t n = 0; n < jobs.size(); ++n) {
    done += work(jobs[n]);
    const bool last_of_tile = n + 1 == jobs.size() || jobs[n + 1].at != jobs[n].at;
    if (!last_of_tile || (done * parts < all * (divided.size() + 1) && n + 1 < jobs.size())) {
      continue;
    }
    divided.push_back(jobs.subspan(begin, n + 1 - begin));
    begin = n + 1;
  }
  return divided;
}

}  // namespace

GroupCarver::GroupCarver(SculptureSettings settings, SolidSnapshot start)
    : settings_(std::move(settings)), start_(std::move(start)) {
  carvers_.emplace_back(settings_, start_);
}

std::expected<void, std::string> GroupCarver::carve(std::span<GroupJob> jobs,
                                                    RecordedMotions& motions, Workers& workers,
                                                    const std::stop_token& stop) {
  if (jobs.empty()) return {};
  const int count = workers.count();
  const auto divided = divide(jobs, static_cast<std::size_t>(count > 1 ? count * kPartsEach : 1));
  while (carvers_.size() < divided.size()) carvers_.emplace_back(settings_, start_);
  std::vector<Part> parts;
  std::vector<std::uint64_t> firsts;
  parts.reserve(divided.size());
  for (std::size_t n = 0; n < divided.size(); ++n) {
    parts.emplace_back(carvers_[n], divided[n]).add_windows(firsts);
  }
  std::ranges::sort(firsts);
  firsts.erase(std::ranges::unique(firsts).begin(), firsts.end());
  for (std::span left(firsts); !left.empty();) {
    const auto now = left.first(std::min(kWindowsAtOnce, left.size()));
    left = left.subspan(now.size());
    const auto windows = motions.windows(now, stop);
    if (windows) {
      workers.run(static_cast<int>(parts.size()), [&](int n) {
        for (const auto& window : *windows) {
          if (stop.stop_requested()) return;
          parts[static_cast<std::size_t>(n)].cut(*window);
        }
      });
    }
    if (!windows || stop.stop_requested()) {
      carvers_.clear();  // They hold tiles of jobs that are not done.
      carvers_.emplace_back(settings_, start_);
      return std::unexpected(windows ? "stopped" : windows.error());
    }
  }
  workers.run(static_cast<int>(parts.size()),
              [&](int n) { parts[static_cast<std::size_t>(n)].finish(); });
  return {};
}

}  // namespace kerf
