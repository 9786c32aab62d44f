// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/lazy_normals.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>
#include <utility>

#include "kernel/math/int_lanes.h"

namespace kerf {
namespace {

/// Codes up to this identify the sweep that made an end whose normal is not yet computed. Codes of
/// normals are at least 2¹⁶ (normal_code.h).
constexpr NormalCode kPendingMax = 0xffff;

/// Fewer tiles are resolved faster than another thread wakes up.
constexpr std::size_t kTilesForThreads = 16;
/// Jobs per thread, to balance the varying number of ends in a tile.
constexpr std::size_t kNormalJobsPerThread = 2;

/// Tiles that are resolved at a time while a batch is collected: about 0.1 ms.
constexpr std::size_t kTilesAtOnce = 32;

/// Ends that are collected before their normals are computed, which bounds the memory of a job to
/// 1 MB. A tile without split columns adds at most 2,048.
constexpr std::size_t kEndsAtOnce = 16'384;

/// Marks those ends of the topmost elements of eight columns, from `first` on, that are now at an
/// end of the removed element.
KERF_INLINE void mark_topmost_in_lanes(DexelTile& tile, std::size_t first,
                                       const RemovedGroup& group, NormalCode code) {
  const IntLanes bottom = load_ints(&tile.bottom[first]), top = load_ints(&tile.top[first]);
  const IntLanes lo = load_ints(group.bottom), hi = load_ints(group.top);
  const IntMask is_cut = less(lo, hi) & less(bottom, top);
  EndCodes* codes = &tile.topmost_codes[first];
  for (unsigned rest = bits(is_cut & equal(top, lo)); rest != 0; rest &= rest - 1) {
    codes[std::countr_zero(rest)].top = code;
  }
  for (unsigned rest = bits(is_cut & equal(bottom, hi)); rest != 0; rest &= rest - 1) {
    codes[std::countr_zero(rest)].bottom = code;
  }
}
KERF_FOR_EACH_TARGET(void, mark_topmost,
                     (DexelTile & tile, std::size_t first, const RemovedGroup& group,
                      NormalCode code),
                     (tile, first, group, code))

/// Computes the normals of the upper or lower ends that one sweep made, eight at a time.
template <class End>
void resolve_ends(const SweptSurface& surface, std::span<const End> ends,
                  std::span<const std::uint32_t> numbers, double towards) {
  for (std::size_t first = 0; first < numbers.size(); first += kLanes) {
    const std::size_t count = std::min<std::size_t>(kLanes, numbers.size() - first);
    Vec3Lanes at{};
    for (int c = 0; c < kLanes; ++c) {
      const End& end = ends[numbers[first + std::min(std::size_t(c), count - 1)]];
      at.x.set(c, end.x_mm);
      at.y.set(c, end.y_mm);
      at.z.set(c, end.z_mm);
    }
    NormalCode codes[kLanes];
    surface.stock_normals(at, (1U << count) - 1, towards, codes);
    for (std::size_t c = 0; c < count; ++c) *ends[numbers[first + c]].code = codes[c];
  }
}

}  // namespace

void mark_ends(DexelTile& tile, std::span<const RemovedGroup> removed, NormalCode code) {
  for (const RemovedGroup& group : removed) {
    const std::int32_t row = group.j % kTileSide;
    const int first = row * kTileSide + group.i % kTileSide;
    mark_topmost(tile, std::size_t(first), group, code);
    const unsigned split = tile.split[std::size_t(row)] >> (group.i % kTileSide) & 0xFFU;
    for (unsigned left = split; left != 0; left &= left - 1) {
      const int c = std::countr_zero(left);
      if (group.bottom[c] >= group.top[c]) continue;
      if (NormalCode* top = tile.lower_top_code(first + c, group.bottom[c])) *top = code;
      if (NormalCode* bottom = tile.lower_bottom_code(first + c, group.top[c])) *bottom = code;
    }
  }
}

NormalCode LazyNormals::add_sweep(DexelField& field, const Tool& tool, const ToolMotion& part) {
  static_assert(2 * kSweepsMax <= kPendingMax);
  if (!field.keeps_normals()) return kStockNormal;
  if (is_full()) {
    SerialWorkers alone;
    begin_batch(field, alone);
  }
  now_.sweeps.emplace_back(tool, part);
  return now_.first_code + static_cast<NormalCode>(now_.sweeps.size() - 1);
}

void LazyNormals::begin_batch(DexelField& field, Workers& workers) {
  finish(field, workers, before_);
  std::swap(now_, before_);
  std::ranges::sort(before_.tiles);
  before_.tiles.erase(std::ranges::unique(before_.tiles).begin(), before_.tiles.end());
}

void LazyNormals::resolve_some(DexelField& field, Workers& workers) {
  const std::size_t due = before_.tiles.size() * now_.sweeps.size() / kSweepsMax;
  if (due >= before_.resolved + kTilesAtOnce) resolve_until(field, workers, before_, due);
}

void LazyNormals::resolve(DexelField& field, Workers& workers) {
  begin_batch(field, workers);
  finish(field, workers, before_);
}

void LazyNormals::finish(DexelField& field, Workers& workers, Batch& batch) {
  resolve_until(field, workers, batch, batch.tiles.size());
  batch.sweeps.clear();
  batch.tiles.clear();
  batch.resolved = 0;
}

/// Resolves the tiles of a batch before the one with the number `end`.
void LazyNormals::resolve_until(DexelField& field, Workers& workers, Batch& batch,
                                std::size_t end) {
  const std::span all = std::span<const TileIndex>(batch.tiles).first(end).subspan(batch.resolved);
  batch.resolved = end;
  if (all.empty()) return;
  const bool divides = workers.count() > 1 && all.size() >= kTilesForThreads;
  const std::size_t jobs = divides ? std::size_t(workers.count()) * kNormalJobsPerThread : 1;
  if (jobs_.size() < jobs) jobs_.resize(jobs);
  const auto run_job = [&](int n) {
    const std::size_t from = all.size() * std::size_t(n) / jobs;
    const std::size_t to = all.size() * std::size_t(n + 1) / jobs;
    resolve_tiles(field, batch, all.subspan(from, to - from), jobs_[std::size_t(n)]);
  };
  if (divides) {
    workers.run(static_cast<int>(jobs), run_job);
  } else {
    run_job(0);
  }
}

void LazyNormals::resolve_tiles(DexelField& field, const Batch& batch,
                                std::span<const TileIndex> tiles, Job& job) {
  for (const TileIndex at : tiles) {
    DexelTile* tile = field.editable(at);
    assert(tile != nullptr);  // It was changed after the last snapshot, so it is not shared.
    collect(*tile, at, field.grid(), batch, job);
    if (job.ends.size() >= kEndsAtOnce) resolve_collected(batch, job);
  }
  resolve_collected(batch, job);
}

void LazyNormals::resolve_collected(const Batch& batch, Job& job) {
  const std::size_t groups = 2 * batch.sweeps.size();
  job.group_begin.assign(groups + 1, 0);
  for (const End& end : job.ends) ++job.group_begin[end.group];
  // Each entry becomes the end of its group, and then, while the group is filled from its last
  // place on, the beginning.
  std::partial_sum(job.group_begin.begin(), job.group_begin.end(), job.group_begin.begin());
  job.by_group.resize(job.ends.size());
  for (std::size_t n = job.ends.size(); n-- > 0;)
    job.by_group[--job.group_begin[job.ends[n].group]] = std::uint32_t(n);
  for (std::size_t group = 0; group < groups; ++group) {
    const std::size_t first = job.group_begin[group];
    const auto numbers = std::span<const std::uint32_t>(job.by_group)
                             .subspan(first, job.group_begin[group + 1] - first);
    resolve_ends<End>(batch.sweeps[group / 2], job.ends, numbers, group % 2 == 0 ? 1 : -1);
  }
  job.ends.clear();
}

void LazyNormals::collect(DexelTile& tile, TileIndex at, const DexelGrid& grid, const Batch& batch,
                          Job& job) {
  const auto take = [&](int column, EndCodes& codes, Dexel element) {
    const double x = grid.x_mm(at.x * kTileSide + column % kTileSide);
    const double y = grid.y_mm(at.y * kTileSide + column / kTileSide);
    const auto add = [&](NormalCode& code, std::int32_t z, std::uint32_t side) {
      if (!batch.has(code)) return;
      const auto sweep = std::uint32_t(code - batch.first_code);
      job.ends.push_back({&code, x, y, grid.z_mm(z), 2 * sweep + side});
    };
    add(codes.top, element.top, 0);
    add(codes.bottom, element.bottom, 1);
  };
  for (int column = 0; column < kTileColumns; ++column) {
    const auto c = std::size_t(column);
    EndCodes& codes = tile.topmost_codes[c];
    if (batch.has(codes.top) || batch.has(codes.bottom)) {
      take(column, codes, {tile.bottom[c], tile.top[c]});
    }
    if (!tile.is_split(column)) continue;
    const std::span<const Dexel> elements = tile.lower.of(column);
    const std::span<EndCodes> lower = tile.lower_codes.edit(column);
    for (std::size_t n = 0; n < lower.size(); ++n) take(column, lower[n], elements[n]);
  }
}

std::size_t LazyNormals::Job::bytes() const {
  return ends.capacity() * sizeof(End) +
         (by_group.capacity() + group_begin.capacity()) * sizeof(std::uint32_t);
}

std::size_t LazyNormals::bytes() const {
  std::size_t sum = 0;
  for (const Batch* batch : {&now_, &before_})
    sum += batch->sweeps.capacity() * sizeof(SweptSurface) +
           batch->tiles.capacity() * sizeof(TileIndex);
  for (const Job& job : jobs_) sum += job.bytes();
  return sum;
}

}  // namespace kerf
