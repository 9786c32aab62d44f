// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <new>

#include "kernel/sweep/column_block.h"
#include "kernel/sweep/disc_rows.h"
#include "kernel/sweep/packed_search.h"
#include "kernel/sweep/slice_search.h"

namespace kerf {

KERF_INLINE void add_span(ColumnBlock& block, int row, double z, const LaneSpan& span,
                          LaneMask where) {
  const Lanes none = std::numeric_limits<double>::infinity();
  block.add(row, select(where, span.lo + z, none), select(where, span.hi + z, -none));
}

/// Returns a lower bound of the share between a station that misses a ray and a hit below `top`.
/// `advance` is the speed at which the piece approaches the ray.
KERF_INLINE Lanes least_share(const SlicePath& path, const Meeting& m, Lanes advance, double top,
                              Lanes length) {
  const Lanes along_ray = greater(magnitude(m.lo - path.lowest_mm), magnitude(top - m.lo));
  const Lanes closing = greater(advance, Lanes(0)) / square_root(m.normal2) +
                        path.frame.turn * along_ray + 0.5 * path.search.bend_mm * length;
  return greater(m.off_side / closing, m.clearance / path.speed_max_mm);
}

/// The rays of a stretch that are bisected, and those that are searched.
struct Division {
  LaneMask halved, searched;
};

/// Divides the rays of a stretch. Bisected are rays that the piece may hit late, leave or hit
/// again: all except those inside at both stations without a gap in between, and those that cannot
/// be reached from either station, which are not searched either. A ray that crosses a hidden disc
/// is inside a neighbor, so only the side counts then. From the level that the bend requires on,
/// only rays that are inside at both stations, but in separate intervals, are bisected.
KERF_INLINE Division divide(const SlicePath& path, const Stretch& stretch, LaneMask asked,
                            double top, int level) {
  const Meeting &first = stretch.first, &last = stretch.last;
  const LaneMask inside = first.hit & last.hit;
  const LaneMask overlap = (first.lo <= last.hi) & (last.lo <= first.hi);
  if (level >= path.search.halvings) {
    const LaneMask halved = level < kHalvingsMax ? asked & inside & ~overlap : ~every_lane();
    return {halved, asked & ~halved};
  }
  const LaneMask sides = (first.side_lo <= last.side_hi) & (last.side_lo <= first.side_hi);
  const LaneMask gap = asked & ~(path.search.shows_disc ? inside & overlap : sides);
  if (!any(gap)) return {gap, asked};
  const Lanes length = stretch.to - stretch.from;
  const Lanes from_first = least_share(path, first, first.advance, top, length);
  const Lanes from_last = least_share(path, last, -last.advance, top, length);
  const LaneMask reached = from_first + from_last <= length;
  return {gap & reached, asked & (~gap | first.hit | last.hit) & ~(gap & reached)};
}

/// Intersections of a row at a share, and the rays that are evaluated between the previous station
/// and this one.
struct Station {
  double share;
  int level;  ///< number of bisections of the stretch that ends here
  LaneMask asked;
  Meeting met;
};

/// The stations that follow, the next one on top. Its memory is not cleared for each row.
class StationStack {
 public:
  KERF_INLINE bool is_empty() const { return count_ == 0; }
  KERF_INLINE Station& top() { return *std::launder(reinterpret_cast<Station*>(at(count_ - 1))); }
  KERF_INLINE void push(const Station& s) { new (at(count_++)) Station(s); }
  KERF_INLINE void pop() { --count_; }

 private:
  KERF_INLINE std::byte* at(std::size_t k) { return memory_ + k * sizeof(Station); }

  alignas(Station) std::byte memory_[(kHalvingsMax + 1) * sizeof(Station)];
  std::size_t count_ = 0;
};

/// Calls search_packed of a side, compiled for each instruction set.
KERF_DECLARE_TARGETS(void, search_packed_cone,
                     (const ConeSide& side, const SlicePath& path, PackedRays& rays, bool finish,
                      ColumnBlock& block))
KERF_DECLARE_TARGETS(void, search_packed_arc,
                     (const ArcSide& side, const SlicePath& path, PackedRays& rays, bool finish,
                      ColumnBlock& block))
inline void search_rays(const ConeSide& side, const SlicePath& path, PackedRays& rays, bool finish,
                        ColumnBlock& block) {
  search_packed_cone(side, path, rays, finish, block);
}
inline void search_rays(const ArcSide& side, const SlicePath& path, PackedRays& rays, bool finish,
                        ColumnBlock& block) {
  search_packed_arc(side, path, rays, finish, block);
}

/// A row of eight rays.
struct RayRow {
  Lanes x, y;
  int number;
};

/// Adds the intervals between two stations to a row, of the rays `asked`. Upper ends are searched
/// only where they lie below `top`.
template <class Side>
KERF_INLINE void sweep_stretch(const Side& side, const SlicePath& path, const RayRow& row,
                               const Stretch& stretch, LaneMask asked, PackedRays& packed,
                               ColumnBlock& block) {
  const double z = path.frame.tip.z;
  LaneSpan span;
  include_hits(span, stretch.first);
  include_hits(span, stretch.last);
  add_span(block, row.number, z, span, asked);
  const LaneMask both = needs_search<End::kLower>(path, stretch, asked, span);
  const LaneMask hidden = hidden_exit(path, stretch);
  const LaneMask upper =
      asked & ~both & ~hidden & (span.lo <= span.hi) & (span.hi < block.top_mm - z);
  for (unsigned left = bits(both | upper); left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    RayBatch& batch = (bits(both) >> lane & 1) != 0 ? packed.both : packed.upper_batch();
    PackedRays::push(batch, lane, row.x, row.y, stretch, span, row.number, lane);
    if (packed.is_full()) search_rays(side, path, packed, false, block);
  }
}

/// Adds the intervals that the piece sweeps between two stations to a row. Rays with a
/// non-connected hit set are bisected repeatedly, because their intervals may be separate: a disc
/// that turns about its diameter leaves a ray on one side and comes back on the other. The last
/// station of `waiting` ends the stretch; `first` is set to it.
template <class Side>
KERF_INLINE void evaluate_stretch(const Side& side, const SlicePath& path, const RayRow& row,
                                  Station& first, StationStack& waiting, PackedRays& packed,
                                  ColumnBlock& block) {
  const double top = block.top_mm - path.frame.tip.z;
  while (!waiting.is_empty()) {
    Station& last = waiting.top();
    const Stretch s{Lanes(first.share), Lanes(last.share), first.met, last.met};
    const Division rays = divide(path, s, last.asked, top, last.level);
    if (any(rays.searched)) sweep_stretch(side, path, row, s, rays.searched, packed, block);
    if (any(rays.halved)) {
      ++last.level;
      last.asked = rays.halved;
      const double share = (first.share + last.share) * 0.5;
      const Meeting met = meet<End::kLower>(side, path, row.x, row.y, share);
      waiting.push({share, last.level, rays.halved, met});
    } else {
      first = last;
      waiting.pop();
    }
  }
}

/// Adds the intervals of a slice at its last pose to a row that is ahead of it.
template <class Side>
KERF_INLINE void add_last_pose(const Side& side, const SlicePath& path, const RayRow& row,
                               LaneMask open, ColumnBlock& block) {
  const TurningFrame::Poses pose = path.frame.at(Lanes(1));
  const Crossing c = cross_piece<End::kLower>(side, pose, row.x, row.y);
  const Lanes middle = pose.tip.z + c.anchor.z;
  const LaneSpan span{middle + c.in, middle + c.out};
  add_span(block, row.number, path.frame.tip.z, span, open & c.hit);
}

/// Adds the intervals that a slice removes along its path to a row.
template <class Side>
KERF_INLINE void evaluate_row(const Side& side, const SlicePath& path, const RayRow& row,
                              LaneMask open, PackedRays& packed, ColumnBlock& block) {
  const int parts = path.search.parts;
  Station first{0, 0, open, meet<End::kLower>(side, path, row.x, row.y, 0)};
  if (!any(open & first.met.hit)) {
    const double top = block.top_mm - path.frame.tip.z;
    open &= least_share(path, first.met, first.met.advance, top, 1) <= 1.0;
    if (!any(open)) return;
  }
  for (int part = 1; part <= parts; ++part) {
    const double share = double(part) / parts;
    StationStack waiting;
    waiting.push({share, 0, open, meet<End::kLower>(side, path, row.x, row.y, share)});
    evaluate_stretch(side, path, row, first, waiting, packed, block);
  }
}

/// Adds the intervals of the rows that need no search, and removes them from the rows to be
/// evaluated. `ahead`: rows in which the slice at its last pose is all that it sweeps.
template <class Side>
KERF_INLINE void add_simple_rows(const Side& side, const SlicePath& path, unsigned ahead,
                                 ColumnBlock& block) {
  const Lanes x = block.x_mm - path.frame.tip.x;
  const bool has_discs = !path.discs.poses.empty();
  for (unsigned left = has_discs ? block.rows : ahead; left != 0; left &= left - 1) {
    const int row = __builtin_ctz(left);
    const Lanes y = block.y_mm[row] - path.frame.tip.y;
    const LaneMask open = block.open(row);
    const bool is_ahead = (ahead >> row & 1) != 0;
    if (!has_discs || !add_disc_row(side, path, y, row, open, is_ahead, block)) {
      if (!is_ahead) continue;
      add_last_pose(side, path, {x, y, row}, open, block);
    }
    block.rows &= ~(1U << row);
  }
}

/// Adds the intervals that a slice removes along its path to the rows of a block.
template <class Side>
KERF_INLINE void evaluate_rows(const Side& side, const SlicePath& path, ColumnBlock& block) {
  const Lanes x = block.x_mm - path.frame.tip.x;
  PackedRays packed;
  for (unsigned left = block.rows; left != 0; left &= left - 1) {
    const int row = __builtin_ctz(left);
    const Lanes y = block.y_mm[row] - path.frame.tip.y;
    evaluate_row(side, path, {x, y, row}, block.open(row), packed, block);
  }
  search_rays(side, path, packed, true, block);
}

/// evaluate_rows and add_simple_rows, compiled for each instruction set. The versions are divided
/// over two units, because together they would be by far the slowest unit of the kernel to compile.
KERF_DECLARE_TARGETS(void, evaluate_cone,
                     (const ConeSide& side, const SlicePath& path, ColumnBlock& block))
KERF_DECLARE_TARGETS(void, evaluate_arc,
                     (const ArcSide& side, const SlicePath& path, ColumnBlock& block))
KERF_DECLARE_TARGETS(void, add_simple_cone_rows,
                     (const ConeSide& side, const SlicePath& path, unsigned ahead,
                      ColumnBlock& block))
KERF_DECLARE_TARGETS(void, add_simple_arc_rows,
                     (const ArcSide& side, const SlicePath& path, unsigned ahead,
                      ColumnBlock& block))

}  // namespace kerf
