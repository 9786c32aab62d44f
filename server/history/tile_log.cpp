// SPDX-License-Identifier: Apache-2.0
#include "server/history/tile_log.h"

#include <algorithm>
#include <span>
#include <utility>

#include "kernel/dexel/common_solid.h"
#include "kernel/dexel/dexel_tile.h"

namespace kerf {
namespace {

/// Runs that may grow at the same time; more hands over one tile end each other's.
constexpr std::size_t kOpenMax = 8;

/// Appends a number in groups of seven bits, the lowest first; all but the last have the high bit.
void put_number(std::vector<std::byte>& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7U) out.push_back(static_cast<std::byte>(value | 0x80U));
  out.push_back(static_cast<std::byte>(value));
}

std::uint64_t get_number(std::span<const std::byte>& in) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; !in.empty(); shift += 7) {
    const auto byte = std::to_integer<std::uint64_t>(in.front());
    in = in.subspan(1);
    value |= (byte & 0x7FU) << shift;
    if (byte < 0x80) break;
  }
  return value;
}

/// Folds the difference of two numbers: 0, −1, 1, −2, …
std::uint64_t folded(std::uint64_t value, std::uint64_t before) {
  const auto difference = static_cast<std::int64_t>(value - before);
  return static_cast<std::uint64_t>(difference) << 1U ^
         static_cast<std::uint64_t>(difference >> 63);
}

std::uint64_t unfolded(std::uint64_t code, std::uint64_t before) {
  return before + (code >> 1U ^ (0 - (code & 1U)));
}

void put_run(std::vector<std::byte>& out, const MotionRun& run, const MotionRun& before) {
  put_number(out, folded(run.stroke, before.stroke));
  put_number(out, folded(run.first, before.last));
  put_number(out, run.last - run.first);
}

std::vector<MotionRun> decoded(std::span<const std::byte> in) {
  std::vector<MotionRun> runs;
  MotionRun run;
  while (!in.empty()) {
    run.stroke = unfolded(get_number(in), run.stroke);
    run.first = unfolded(get_number(in), run.last);
    run.last = run.first + get_number(in);
    runs.push_back(run);
  }
  return runs;
}

/// Joins what two groups leave of a tile.
std::shared_ptr<const DexelTile> common(const std::shared_ptr<const DexelTile>& a,
                                        const std::shared_ptr<const DexelTile>& b) {
  if (!a || !b) return a ? a : b;
  auto both = std::make_shared<DexelTile>(*a);
  keep_common(*both, *b);
  return both;
}

MotionGroup joined(const MotionGroup& a, const MotionGroup& b) {
  MotionGroup both{.first = a.first, .last = b.last, .motions = a.motions + b.motions, .runs = {}};
  MotionRun before;
  for (const auto* group : {&a, &b}) {
    for (const MotionRun& run : decoded(group->runs)) {
      put_run(both.runs, run, before);
      before = run;
    }
  }
  both.runs.shrink_to_fit();
  if (!a.is_carved || !b.is_carved) return both;
  both.is_carved = true;
  both.tile = common(a.tile, b.tile);
  both.used = std::min(a.used, b.used);
  std::ranges::set_union(a.without, b.without, std::back_inserter(both.without));
  return both;
}

}  // namespace

void TileLog::close_run(const MotionRun& run) {
  put_run(groups_.back().runs, run, last_closed_);
  last_closed_ = run;
}

void TileLog::close_group() {
  for (const MotionRun& run : std::exchange(open_, {})) close_run(run);
  groups_.back().runs.shrink_to_fit();
  is_open_ = false;
  if (groups_.size() >= kGroupsMax) join_groups();
}

void TileLog::join_groups() {
  std::vector<MotionGroup> halves;
  for (std::size_t n = 0; n < groups_.size(); n += 2) {
    halves.push_back(n + 1 < groups_.size() ? joined(groups_[n], groups_[n + 1])
                                            : std::move(groups_[n]));
  }
  groups_ = std::move(halves);
  motions_of_group_ *= 2;
}

void TileLog::add(std::uint64_t record, StrokeId stroke) {
  if (!std::exchange(is_open_, true)) {
    groups_.push_back({.first = record, .runs = {}});
    last_closed_ = {};
  }
  MotionGroup& group = groups_.back();
  group.last = record;
  ++group.motions;
  group.is_carved = false;
  group.tile = nullptr;
  const auto run = std::ranges::find(open_, stroke, &MotionRun::stroke);
  if (run != open_.end() && record - run->last <= kGap) {
    run->last = record;
  } else {
    const auto ended = run != open_.end() || open_.size() < kOpenMax ? run : open_.begin();
    if (ended != open_.end()) {
      close_run(*ended);
      open_.erase(ended);
    }
    open_.push_back({stroke, record, record});
  }
  if (group.motions >= motions_of_group_) close_group();
}

std::vector<MotionRun> TileLog::runs(std::size_t group) const {
  std::vector<MotionRun> runs = decoded(groups_[group].runs);
  if (is_open_ && group + 1 == groups_.size()) {
    runs.insert(runs.end(), open_.begin(), open_.end());
  }
  return runs;
}

std::size_t TileLog::bytes() const {
  std::size_t bytes = sizeof *this + groups_.capacity() * sizeof(MotionGroup) +
                      open_.capacity() * sizeof(MotionRun);
  for (const MotionGroup& group : groups_) {
    bytes += group.runs.capacity() + group.without.capacity() * sizeof(StrokeId);
  }
  return bytes;
}

}  // namespace kerf
