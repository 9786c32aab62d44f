// SPDX-License-Identifier: Apache-2.0
#include "server/history/return_carver.h"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

#include "kernel/dexel/common_solid.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/motion_reach.h"

namespace kerf {
namespace {

/// Spans that a tile cuts before its stock is checked again, and windows read for that.
constexpr std::size_t kSpansAtOnce = 32;
constexpr std::size_t kWindowsOfTurn = 64;

bool meets(std::span<const Bounds> boxes, const Bounds& box) {
  return std::ranges::any_of(boxes, [&](const Bounds& each) { return kerf::meets(each, box); });
}
bool meets(std::span<const Bounds> boxes, const RecordedMotion& motion) {
  const Bounds reach = reach_of(*motion.tool, motion.motion);
  return std::ranges::any_of(boxes, [&](const Bounds& each) {
    return kerf::meets(each, reach) && may_meet(*motion.tool, motion.motion, each);
  });
}

const RecordedMotions::Window& window_of(const RecordedMotions::Windows& windows,
                                         std::uint64_t record) {
  const auto after = std::ranges::upper_bound(windows, record, {},
                                              [](const auto& window) { return window->first; });
  return **std::prev(after);
}

}  // namespace

ReturnCarver::ReturnCarver(SculptureSettings settings, SolidSnapshot start)
    : settings_(std::move(settings)), start_(std::move(start)) {
  for (const DexelSnapshot& field : start_.fields) {
    margin_mm_ = std::max(margin_mm_, settings_.tolerance_mm + field.grid().z_quantum_mm);
  }
}

/// Boxes around the content of a tile, with the margin, or empty for an empty tile.
std::vector<Bounds> ReturnCarver::boxes_of(const DexelTile& tile, FieldTile at) const {
  const auto field = std::ranges::find(start_.fields, at.axis,
                                       [](const DexelSnapshot& f) { return f.grid().axis; });
  std::vector<Bounds> boxes;
  for (const BoxStock& box : solid_boxes(tile, at.tile, field->grid())) {
    boxes.push_back(
        grown({from_frame(at.axis, box.min_mm), from_frame(at.axis, box.max_mm)}, margin_mm_));
  }
  return boxes;
}

/// The next spans of each job that meet its stock, and their windows.
std::vector<ReturnCarver::Turn> ReturnCarver::next_turns(std::span<ReturnJob> jobs,
                                                         std::vector<std::uint64_t>& firsts) const {
  std::vector<Turn> turns;
  std::vector<std::vector<Bounds>> boxes;
  for (ReturnJob& job : jobs) {
    if (!job.stock || job.next == job.spans.size()) continue;
    turns.push_back({&job, job.next});
    boxes.push_back(boxes_of(*job.stock, job.at));
  }
  std::set<std::uint64_t> needed;
  for (std::size_t n = 0; n < kSpansAtOnce && needed.size() < kWindowsOfTurn; ++n) {
    for (std::size_t t = 0; t < turns.size() && needed.size() < kWindowsOfTurn; ++t) {
      auto& [job, end] = turns[t];
      while (end < job->spans.size() && !meets(boxes[t], job->spans[end]->bounds())) ++end;
      if (end == job->spans.size()) continue;
      const MotionRun& run = job->spans[end++]->run;
      for (auto first = RecordedMotions::window_begin(run.first); first <= run.last;
           first += RecordedMotions::kWindow) {
        needed.insert(first);
      }
    }
  }
  firsts.assign(needed.begin(), needed.end());
  // The longest first, so that no worker waits long for another.
  std::ranges::stable_sort(turns, std::greater(),
                           [](const Turn& turn) { return turn.end - turn.job->next; });
  return turns;
}

std::unique_ptr<TileCarver> ReturnCarver::take_carver() {
  {
    const std::lock_guard lock(mutex_);
    if (!carvers_.empty()) {
      auto carver = std::move(carvers_.back());
      carvers_.pop_back();
      return carver;
    }
  }
  return std::make_unique<TileCarver>(settings_, start_);
}

void ReturnCarver::work(const Turn& turn, std::uint64_t last,
                        const RecordedMotions::Windows& windows) {
  ReturnJob& job = *turn.job;
  auto carver = take_carver();
  carver->begin(job.at, job.stock);
  auto boxes = boxes_of(*job.stock, job.at);
  for (; job.next < turn.end && !boxes.empty(); ++job.next) {
    const MotionSpan& span = *job.spans[job.next];
    if (!meets(boxes, span.bounds())) continue;
    const RecordedMotion* before = nullptr;  // has been cut, or does not reach the stock
    for (auto record = span.run.first; record <= std::min(span.run.last, last); ++record) {
      const RecordedMotions::Window& window = window_of(windows, record);
      const RecordedMotion& motion = window.motions[record - window.first];
      if (motion.tool == nullptr || motion.stroke != span.run.stroke) continue;
      const RecordedMotion* previous = std::exchange(before, &motion);
      if (!meets(boxes, motion)) continue;
      carver->cut(*motion.tool, motion.motion, {&job.at, 1}, continues(previous, motion));
    }
    boxes = boxes_of(*carver->find(job.at), job.at);
  }
  job.stock = carver->take(job.at);
  if (boxes.empty()) job.stock = nullptr;
  const std::lock_guard lock(mutex_);
  carvers_.push_back(std::move(carver));
}

std::expected<void, std::string> ReturnCarver::carve(std::span<ReturnJob> jobs, std::uint64_t last,
                                                     RecordedMotions& motions, Workers& workers,
                                                     const std::stop_token& stop) {
  for (ReturnJob& job : jobs) {
    if (job.stock && boxes_of(*job.stock, job.at).empty()) job.stock = nullptr;
    std::ranges::sort(job.spans, {}, [](const MotionSpan* s) { return s->lo_mm[2]; });
  }
  for (;;) {
    std::vector<std::uint64_t> firsts;
    const std::vector<Turn> turns = next_turns(jobs, firsts);
    if (turns.empty()) return {};
    const auto windows = motions.windows(firsts, stop);
    if (!windows) return std::unexpected(windows.error());
    workers.run(static_cast<int>(turns.size()),
                [&](int n) { work(turns[static_cast<std::size_t>(n)], last, *windows); });
  }
}

}  // namespace kerf
