// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sweep/column_block.h"
#include "kernel/sweep/slice_search.h"

namespace kerf {

/// Returns the intervals that the piece sweeps of the rays `asked` between two stations. Upper ends
/// are searched only where they lie below `top`.
template <class Side>
KERF_INLINE LaneSpan sweep_stretch(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                                   const Stretch& stretch, LaneMask asked, double top) {
  LaneSpan span;
  include_hits(span, stretch.first);
  include_hits(span, stretch.last);
  search_stretch<End::kLower>(side, path, x, y, stretch, asked, span);
  const LaneMask inside = asked & (span.lo <= span.hi) & (span.hi < top);
  if (any(inside)) {
    const Meeting first = meet<End::kUpper>(side, path, x, y, stretch.from);
    const Meeting last = meet<End::kUpper>(side, path, x, y, stretch.to);
    search_stretch<End::kUpper>(side, path, x, y, {stretch.from, stretch.to, first, last}, inside,
                                span);
  }
  return span;
}

KERF_INLINE void add_span(ColumnBlock& block, int row, double z, const LaneSpan& span,
                          LaneMask where) {
  const Lanes none = std::numeric_limits<double>::infinity();
  block.add(row, select(where, span.lo + z, none), select(where, span.hi + z, -none));
}

/// Returns a lower bound of the share between a station that misses a ray and a hit below `top`.
/// `advance` is the speed at which the piece approaches the ray.
KERF_INLINE Lanes least_share(const SlicePath& path, const Meeting& m, Lanes advance, double top,
                              double length) {
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
  const double length = stretch.to - stretch.from;
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

/// Adds the intervals that the piece sweeps between two stations to a row. Rays with a
/// non-connected hit set are bisected repeatedly, because their intervals may be separate: a disc
/// that turns about its diameter leaves a ray on one side and comes back on the other. `waiting[0]`
/// is the last station; `first` is set to it.
template <class Side>
KERF_INLINE void evaluate_stretch(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                                  Station& first, Station* waiting, int row, ColumnBlock& block) {
  const double z = path.frame.tip.z, top = block.top_mm - z;
  for (int count = 1; count > 0;) {
    Station& last = waiting[count - 1];
    const Stretch s{first.share, last.share, first.met, last.met};
    const Division rays = divide(path, s, last.asked, top, last.level);
    if (any(rays.searched)) {
      const LaneSpan span = sweep_stretch(side, path, x, y, s, rays.searched, top);
      add_span(block, row, z, span, rays.searched);
    }
    if (any(rays.halved)) {
      ++last.level;
      last.asked = rays.halved;
      const double share = (s.from + s.to) * 0.5;
      const Meeting met = meet<End::kLower>(side, path, x, y, share);
      waiting[count++] = Station{share, last.level, rays.halved, met};
    } else {
      first = last;
      --count;
    }
  }
}

/// Adds the intervals that a slice removes along its path to the rows of a block.
template <class Side>
KERF_INLINE void evaluate_rows(const Side& side, const SlicePath& path, ColumnBlock& block) {
  const Lanes x = block.x_mm - path.frame.tip.x;
  const int parts = path.search.parts;
  Station first, waiting[kHalvingsMax + 1];
  for (int row = 0; row < kBlockSide; ++row) {
    if ((block.rows >> row & 1) == 0) continue;
    const Lanes y = block.y_mm[row] - path.frame.tip.y;
    LaneMask open = block.open(row);
    first = Station{0, 0, open, meet<End::kLower>(side, path, x, y, 0)};
    if (!any(open & first.met.hit)) {
      const double top = block.top_mm - path.frame.tip.z;
      open &= least_share(path, first.met, first.met.advance, top, 1) <= 1.0;
      if (!any(open)) continue;
    }
    for (int part = 1; part <= parts; ++part) {
      const double share = double(part) / parts;
      waiting[0] = Station{share, 0, open, meet<End::kLower>(side, path, x, y, share)};
      evaluate_stretch(side, path, x, y, first, waiting, row, block);
    }
  }
}

/// evaluate_rows, compiled for each instruction set. The versions are divided over two units,
/// because together they would be by far the slowest unit of the kernel to compile.
KERF_DECLARE_TARGETS(void, evaluate_cone,
                     (const ConeSide& side, const SlicePath& path, ColumnBlock& block))
KERF_DECLARE_TARGETS(void, evaluate_arc,
                     (const ArcSide& side, const SlicePath& path, ColumnBlock& block))

}  // namespace kerf
