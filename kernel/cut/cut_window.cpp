// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/cut_window.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <variant>

#include "kernel/cut/reach.h"

namespace kerf {
namespace {

/// Measured cost of evaluating one piece over a block of 8 x 8 columns, relative to a ball's.
struct WorkPerBlock {
  double operator()(const BallSweep&) const { return 1; }
  double operator()(const FrustumTranslation&) const { return 4; }
  double operator()(const ArcTranslation&) const { return 6; }
  double operator()(const TurningSweep&) const { return 20; }
};
/// Work, in blocks of a ball, from which on several threads are used. Less work takes about as long
/// as waking another thread.
constexpr double kWorkForThreads = 400;
/// Jobs per thread. More jobs balance the varying cost of tiles; fewer reduce the overhead per job.
constexpr std::size_t kJobsPerThread = 8;
/// Tiles of the rectangle around a sweep that are examined before the window is full.
constexpr std::int64_t kTilesOfStep = CutWindow::kTouchesMax;

}  // namespace

std::int64_t CutWindow::add(DexelField& field, const SweptTool& swept, NormalCode end_code,
                            std::int64_t first) {
  tiles_.clear();
  ReachSize reach;
  do {
    reach = find_tiles(field.grid(), swept, {first, kTilesOfStep}, tiles_);
    first += kTilesOfStep;
  } while (first < reach.tiles && touches_.size() + tiles_.size() < kTouchesMax);
  const auto tiles = static_cast<std::int64_t>(tiles_.size());
  const double blocks = double(std::min(reach.blocks, tiles * kTileBlocks));
  double work = 0;
  for (const SweptPiece& piece : swept.pieces) work += std::visit(WorkPerBlock{}, piece);
  for (const TileIndex tile : tiles_) touches_.push_back({sweeps_.size(), tile});
  sweeps_.push_back({&field, &swept, end_code, tiles > 0 ? work * blocks / double(tiles) : 0});
  work_ += work * blocks;
  return first < reach.tiles ? first : 0;
}

void CutWindow::clear() {
  sweeps_.clear();
  touches_.clear();
  work_ = 0;
}

void CutWindow::cut(Workers& workers, const Visit& visit) {
  sort_by_tile();
  const bool divides = workers.count() > 1 && work_ >= kWorkForThreads;
  const auto runs = divide(divides ? std::size_t(workers.count()) * kJobsPerThread : 1);
  if (jobs_.size() < runs.size()) jobs_.resize(runs.size());
  const auto run_job = [&](int n) { run(jobs_[std::size_t(n)], runs[std::size_t(n)], visit); };
  if (runs.size() == 1) {
    run_job(0);
  } else if (!runs.empty()) {
    workers.run(static_cast<int>(runs.size()), run_job);
  }
  // Only this thread changes the directories of tiles.
  for (std::size_t n = 0; n < runs.size(); ++n) jobs_[n].cutter.put_tiles();
}

bool CutWindow::same_tile(std::size_t a, std::size_t b) const {
  return touches_[a].tile == touches_[b].tile &&
         sweeps_[touches_[a].sweep].field == sweeps_[touches_[b].sweep].field;
}

/// A single sweep is already in the order of the tiles.
void CutWindow::sort_by_tile() {
  by_tile_.resize(touches_.size());
  std::iota(by_tile_.begin(), by_tile_.end(), std::size_t{0});
  if (sweeps_.size() == 1) return;
  const auto place = [this](std::size_t n) {
    const Touch& touch = touches_[n];
    return std::tuple(sweeps_[touch.sweep].field->grid().axis, touch.tile, n);
  };
  std::ranges::sort(by_tile_, {}, place);
}

/// Divides the touches into runs of whole tiles with about equal work, at most `jobs`.
std::vector<std::span<const std::size_t>> CutWindow::divide(std::size_t jobs) const {
  std::vector<std::span<const std::size_t>> runs;
  const std::span<const std::size_t> all = by_tile_;
  if (jobs == 1 && !all.empty()) return {all};
  std::size_t begin = 0;
  double done = 0;
  for (std::size_t n = 0; n < all.size(); ++n) {
    done += sweeps_[touches_[all[n]].sweep].work;
    const bool is_last = n + 1 == all.size();
    if (!is_last &&
        (same_tile(all[n], all[n + 1]) || done * double(jobs) < work_ * double(runs.size() + 1))) {
      continue;
    }
    runs.push_back(all.subspan(begin, n + 1 - begin));
    begin = n + 1;
  }
  return runs;
}

void CutWindow::run(Job& job, std::span<const std::size_t> touches, const Visit& visit) {
  for (std::size_t n = 0; n < touches.size(); ++n) {
    const std::size_t number = touches[n];
    const Touch& touch = touches_[number];
    const Sweep& sweep = sweeps_[touch.sweep];
    if (n == 0 || !same_tile(touches[n - 1], number)) job.cutter.begin(*sweep.field, touch.tile);
    job.removed.clear();
    job.cutter.cut(*sweep.swept, sweep.end_code, job.removed);
    if (job.removed.quanta > 0) visit(number, job.removed);
  }
}

}  // namespace kerf
