// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstring>
#include <limits>
#include <new>
#include <utility>

#include "kernel/sweep/column_block.h"
#include "kernel/sweep/slice_search.h"

namespace kerf {

/// Copies lane `from` of `source` to lane `to` of `target`. T consists of Lanes and LaneMasks only.
template <class T>
KERF_INLINE void copy_lane(const T& source, int from, T& target, int to) {
  static_assert(sizeof(T) % sizeof(Lanes) == 0 && sizeof(Lanes) == kLanes * sizeof(double));
  const auto* in = reinterpret_cast<const char*>(&source) + std::size_t(from) * sizeof(double);
  auto* out = reinterpret_cast<char*>(&target) + std::size_t(to) * sizeof(double);
  for (std::size_t k = 0; k < sizeof(T); k += sizeof(Lanes)) {
    std::memcpy(out + k, in + k, sizeof(double));
  }
}

/// Eight rays of any rows of a block, each with a stretch of its own and its ends at the stations.
struct RayBatch {
  Lanes x, y, from, to;
  Meeting first, last;
  LaneSpan span;
  LaneMask settled;  ///< the upper end needs no search
  int row[kLanes], lane[kLanes];
  int count = 0;

  KERF_INLINE Stretch stretch() const { return {from, to, first, last}; }
  KERF_INLINE LaneMask used() const { return lane_numbers() < Lanes(count); }

  KERF_INLINE void copy(int source_lane, const Lanes& ray_x, const Lanes& ray_y, const Stretch& of,
                        const LaneSpan& ends, const LaneMask& upper_settled, int at) {
    copy_lane(ray_x, source_lane, x, at);
    copy_lane(ray_y, source_lane, y, at);
    copy_lane(of.from, source_lane, from, at);
    copy_lane(of.to, source_lane, to, at);
    copy_lane(of.first, source_lane, first, at);
    copy_lane(of.last, source_lane, last, at);
    copy_lane(ends, source_lane, span, at);
    copy_lane(upper_settled, source_lane, settled, at);
  }
  /// Fills the empty lanes with the first ray, so that no other value delays an iteration.
  KERF_INLINE void fill_up() {
    for (int k = count; k < kLanes; ++k) copy(0, x, y, stretch(), span, settled, k);
  }
  /// Adds the intervals in `span` to the rows of a block.
  KERF_INLINE void add_to(ColumnBlock& block, LaneMask which) const {
    const Lanes none = std::numeric_limits<double>::infinity();
    for (int k = 0; k < count;) {
      Lanes lo = none, hi = -none;
      const int of_row = row[k];
      for (; k < count && row[k] == of_row && !(lo[lane[k]] <= hi[lane[k]]); ++k) {
        if ((bits(which) >> k & 1) == 0) continue;
        lo.set(lane[k], span.lo[k]);
        hi.set(lane[k], span.hi[k]);
      }
      block.add(of_row, lo, hi);
    }
  }
};

/// Rays whose outermost ends must be searched between two stations. In most rows these are one or
/// two of eight, so they are collected and searched eight at a time. The composition of a batch
/// does not change a bit, because each ray is searched on its own.
struct PackedRays {
  RayBatch both;   ///< both ends are searched
  RayBatch upper;  ///< the upper end is searched
  RayBatch spare;  ///< more of them, while `upper` is full

  KERF_INLINE bool is_full() const { return both.count == kLanes || upper.count == kLanes; }

  KERF_INLINE static void push(RayBatch& batch, int lane, const Lanes& x, const Lanes& y,
                               const Stretch& stretch, const LaneSpan& span,
                               const LaneMask& settled, int row, int row_lane) {
    batch.row[batch.count] = row;
    batch.lane[batch.count] = row_lane;
    batch.copy(lane, x, y, stretch, span, settled, batch.count);
    ++batch.count;
  }
  KERF_INLINE RayBatch& upper_batch() { return upper.count < kLanes ? upper : spare; }
};

/// Memory of packed rays that is not cleared, because a batch is filled up before it is read.
class PackedMemory {
 public:
  KERF_INLINE PackedRays& empty() {
    PackedRays& rays = *std::launder(reinterpret_cast<PackedRays*>(memory_));
    rays.both.count = rays.upper.count = rays.spare.count = 0;
    return rays;
  }

 private:
  alignas(PackedRays) std::byte memory_[sizeof(PackedRays)];
};

/// Searches the full batches of `rays`, or all of them with `finish`, and adds the intervals to the
/// block.
template <class Side>
KERF_INLINE void search_packed(const Side& side, const SlicePath& path, PackedRays& rays,
                               bool finish, ColumnBlock& block) {
  const double top = block.top_mm;
  RayBatch& b = rays.both;
  if (b.count == kLanes || (finish && b.count > 0)) {
    b.fill_up();
    block.stations +=
        search_stretch<End::kLower>(side, path, b.x, b.y, b.stretch(), b.used(), b.span);
    b.add_to(block, every_lane());
    const LaneMask inside = b.used() & ~b.settled & (b.span.lo <= b.span.hi) & (b.span.hi < top);
    for (unsigned left = bits(inside); left != 0; left &= left - 1) {
      const int k = __builtin_ctz(left);
      PackedRays::push(rays.upper_batch(), k, b.x, b.y, b.stretch(), b.span, b.settled, b.row[k],
                       b.lane[k]);
    }
    b.count = 0;
  }
  RayBatch& u = rays.upper;
  while (u.count == kLanes || (finish && u.count > 0)) {
    u.fill_up();
    const Meeting first = meet<End::kUpper>(side, path, u.x, u.y, u.from);
    const Meeting last = meet<End::kUpper>(side, path, u.x, u.y, u.to);
    block.stations += search_stretch<End::kUpper>(side, path, u.x, u.y, {u.from, u.to, first, last},
                                                  u.used(), u.span);
    u.add_to(block, every_lane());
    u.count = 0;
    if (rays.spare.count > 0) std::swap(u, rays.spare);
  }
}

}  // namespace kerf
