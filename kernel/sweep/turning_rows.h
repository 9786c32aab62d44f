// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <new>

#include "kernel/sweep/column_block.h"
#include "kernel/sweep/disc_rows.h"
#include "kernel/sweep/packed_search.h"
#include "kernel/sweep/slice_search.h"

namespace kerf {

KERF_INLINE void add_span(ColumnBlock& block, int row, const LaneSpan& span, LaneMask where) {
  const Lanes none = std::numeric_limits<double>::infinity();
  block.add(row, select(where, span.lo, none), select(where, span.hi, -none));
}

/// Returns a lower bound of the share between a station that misses a ray and a hit below `top`.
/// `closing` is the speed at which the piece approaches the ray. A pass at up to kRecedingMm off
/// the piece counts as a hit.
KERF_INLINE Lanes least_share(const SlicePath& path, const Meeting& m, Lanes closing, double top,
                              Lanes length) {
  return reach_of_miss(path, FoundEnd::of<End::kLower>(Lanes(0), m), closing, -kRecedingMm, top,
                       length);
}

/// A row of eight rays.
struct RayRow {
  Lanes x, y;
  int number;
  bool hides_entry, hides_exit;  ///< as in RowBits
  Lanes stock_lo, stock_hi;      ///< as in ColumnBlock
};

/// The rays of a stretch that are bisected, and those that are searched.
struct Division {
  LaneMask halved, searched;
};

/// Returns the depth in the piece of the middle of each ray's interval at a station.
template <class Side>
KERF_INLINE Lanes depth_at(const Side& side, const SlicePath& path, const RayRow& row, Lanes share,
                           const Meeting& m) {
  const TurningFrame::Poses pose = path.frame.placed(share);
  const Vec3Lanes& u = pose.u;
  const Vec3Lanes anchor = u * Lanes(side.anchor);
  const Vec3Lanes p{row.x - (pose.tip.x + anchor.x), row.y - (pose.tip.y + anchor.y),
                    (m.lo + m.hi) * 0.5 - (pose.tip.z + anchor.z)};
  const Lanes l = dot(p, u);
  return -greater(side.clearance(p, l, u), greater(side.low - l, l - side.high));
}

/// Returns the rays that are hit at both stations but may leave the piece in between by more than
/// the search may miss (kernel/sweep/bounds.md, "Rays met intermittently").
template <class Side>
KERF_INLINE LaneMask may_leave(const Side& side, const SlicePath& path, const RayRow& row,
                               const Stretch& stretch) {
  const Meeting &first = stretch.first, &last = stretch.last;
  const TurningFrame& f = path.frame;
  const Lanes length = stretch.to - stretch.from;
  const Lanes rise = ((last.lo + last.hi) - (first.lo + first.hi)) * 0.5;
  const Vec3Lanes run = Vec3Lanes{Lanes(0), Lanes(0), rise} - f.v * length;
  const Vec3Lanes aside = cross(f.k, run);
  const Lanes turn = f.turn * length;
  const Lanes bulge = turn * (0.125 * path.reach_mm * turn + 0.25 * square_root(dot(aside, aside)));
  const LaneMask far = bulge > path.search.search_mm;
  if (!any(far)) return far;
  return far & (bulge > lesser(depth_at(side, path, row, stretch.from, first),
                               depth_at(side, path, row, stretch.to, last)));
}

/// Selects the rays of a stretch to bisect and to search. Bisected are those that the piece may hit
/// late, leave or hit again: all rays except those inside at both stations without a gap in
/// between, and those that cannot be reached from either station, which are not searched either. A
/// ray that crosses a hidden disc is inside a neighbor, so only the side counts then. From the
/// level on that the bend requires, only rays that are inside at both stations, but may leave the
/// piece in between, are bisected.
template <class Side>
KERF_INLINE Division divide(const Side& side, const SlicePath& path, const RayRow& row,
                            const Stretch& stretch, LaneMask asked, int level,
                            const ColumnBlock& block) {
  const Meeting &first = stretch.first, &last = stretch.last;
  const double top = block.top_mm + block.join_mm;
  const LaneMask inside = first.hit & last.hit;
  const LaneMask overlap = (first.lo <= last.hi) & (last.lo <= first.hi);
  if (level >= path.search.halvings) {
    LaneMask halved = asked & inside & ~overlap;
    if (level >= kHalvingsMax || !any(halved)) return {~every_lane(), asked};
    const double join = block.join_mm;
    halved &= ~((first.lo <= last.hi + join) & (last.lo <= first.hi + join));
    if (any(halved)) halved &= may_leave(side, path, row, stretch);
    return {halved, asked & ~halved};
  }
  const LaneMask sides = (first.side_lo <= last.side_hi) & (last.side_lo <= first.side_hi);
  const LaneMask gap = asked & ~(path.search.shows_disc ? inside & overlap : sides);
  if (!any(gap)) return {gap, asked};
  const Lanes length = stretch.to - stretch.from;
  const Lanes from_first = least_share(path, first, first.advance, top, length);
  const Lanes from_last = least_share(path, last, -last.advance, top, length);
  LaneMask reached = gap & (from_first + from_last <= length);
  const LaneMask missed = reached & ~first.hit & ~last.hit;
  if (any(missed)) {
    const Gap open = gap_beside(side, path, row.x, row.y, stretch);
    reached &= ~missed | open.open();
  }
  return {reached, asked & (~gap | first.hit | last.hit) & ~reached};
}

/// Intersections of a row at a share, and the rays that are evaluated between the previous station
/// and this one.
struct Station {
  double share;
  int level;  ///< number of bisections of the stretch that ends here
  LaneMask asked;
  Meeting met;
};

/// The stations of a row. Pending stations are on a stack, the next one on top. They are never
/// copied, because an intersection takes a kilobyte. The memory is not cleared for each row.
class Stations {
 public:
  /// Intersects the rays of a row at a share.
  template <class Side>
  KERF_INLINE Station& add(const Side& side, const SlicePath& path, const RayRow& row, double share,
                           int level, LaneMask asked) {
    TurningFrame::Poses pose;
    std::byte* slot =
        spare_count_ > 0 ? spare_[--spare_count_] : memory_ + made_++ * sizeof(Station);
    return *new (slot)
        Station{share, level, asked,
                meet_at<End::kLower>(side, path, row.x, row.y, path.pose(share, pose))};
  }
  /// Reuses the memory of a station.
  KERF_INLINE void drop(Station& s) { spare_[spare_count_++] = reinterpret_cast<std::byte*>(&s); }
  KERF_INLINE bool none_waits() const { return count_ == 0; }
  KERF_INLINE Station& next() const { return *waiting_[count_ - 1]; }
  KERF_INLINE void push(Station& s) { waiting_[count_++] = &s; }
  KERF_INLINE void pop() { --count_; }

 private:
  /// The first and the last station of a motion, and those between the last two reached.
  static constexpr int kSlots = kHalvingsMax + 3;

  alignas(Station) std::byte memory_[kSlots * sizeof(Station)];
  std::byte* spare_[kSlots];
  Station* waiting_[kSlots];
  std::size_t made_ = 0, spare_count_ = 0, count_ = 0;
};

/// search_packed, compiled for each instruction set.
KERF_DECLARE_TARGETS(void, search_packed_rays,
                     (const PieceSide& side, const SlicePath& path, PackedRays& rays, bool finish,
                      ColumnBlock& block))

/// Adds the intervals between two stations to a row, for the rays `asked`. Upper ends are searched
/// only if they are below `top`.
template <class Side>
KERF_INLINE void sweep_stretch(const Side& side, const SlicePath& path, const RayRow& row,
                               const Stretch& stretch, LaneMask asked, PackedRays& packed,
                               ColumnBlock& block) {
  LaneSpan span;
  include_hits(span, stretch.first);
  include_hits(span, stretch.last);
  add_span(block, row.number, span, asked);
  const LaneMask none = ~every_lane();
  const LaneMask hidden_entry = row.hides_entry ? enters_by_disc(path, stretch) : none;
  const LaneMask hidden = row.hides_exit ? leaves_by_disc(path, stretch) : none;
  const LaneMask both =
      needs_search<End::kLower>(side, path, row.x, row.y, stretch, asked & ~hidden_entry, span);
  const LaneMask empty = span.lo > span.hi;
  LaneMask upper =
      asked & ~hidden & ~block.loses_all_above(row.number) & (empty | (span.hi < block.top_mm));
  // The upper end of a ray that both stations miss is searched if the lower one is found.
  const LaneMask unknown = upper & empty;
  upper &= ~empty;
  if (any(upper)) {
    const Meeting first = at_upper_end(side, path, row.x, row.y, stretch.from[0], stretch.first);
    const Meeting last = at_upper_end(side, path, row.x, row.y, stretch.to[0], stretch.last);
    upper = needs_search<End::kUpper>(side, path, row.x, row.y,
                                      {stretch.from, stretch.to, first, last}, upper, span);
  }
  const LaneMask settled = ~(upper | unknown);
  upper &= ~both;
  for (unsigned left = bits(both | upper); left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    RayBatch& batch = (bits(both) >> lane & 1) != 0 ? packed.both : packed.upper_batch();
    PackedRays::push(batch, lane, row.x, row.y, stretch, span, settled, row.number, lane);
    if (packed.is_full()) search_rays(side, path, packed, false, block);
  }
}

/// Adds the intervals that the piece sweeps between two stations to a row. Rays with a
/// non-connected hit set are bisected repeatedly, because their intervals may be separate: a disc
/// that turns about its diameter leaves a ray on one side and returns on the other. The single
/// pending station ends the stretch, and is returned; `first` is dropped.
template <class Side>
KERF_INLINE Station& evaluate_stretch(const Side& side, const SlicePath& path, const RayRow& row,
                                      Station* first, Stations& stations, PackedRays& packed,
                                      ColumnBlock& block) {
  while (!stations.none_waits()) {
    Station& last = stations.next();
    const Stretch s{Lanes(first->share), Lanes(last.share), first->met, last.met};
    const Division rays = divide(side, path, row, s, last.asked, last.level, block);
    if (any(rays.searched)) sweep_stretch(side, path, row, s, rays.searched, packed, block);
    if (any(rays.halved)) {
      ++last.level;
      last.asked = rays.halved;
      const double share = (first->share + last.share) * 0.5;
      stations.push(stations.add(side, path, row, share, last.level, rays.halved));
      ++block.stations;
    } else {
      stations.drop(*first);
      first = &last;
      stations.pop();
    }
  }
  return *first;
}

/// Adds the intervals of a slice at its last pose to a row that is ahead of it.
template <class Side>
KERF_INLINE void add_last_pose(const Side& side, const SlicePath& path, const RayRow& row,
                               LaneMask open, ColumnBlock& block) {
  const TurningFrame::Poses& pose = path.last;
  const Crossing c = cross_piece<End::kLower>(side, pose, row.x, row.y, path.search.top_mm);
  const Lanes middle = pose.tip.z + c.anchor.z;
  const LaneSpan span{middle + c.in, middle + c.out};
  add_span(block, row.number, span, open & c.hit);
}

/// The rays of a row for which an end is known after the first or the last pose has been evaluated.
struct KnownEnds {
  LaneMask lower, upper;

  KERF_INLINE LaneMask both() const { return lower & upper; }
};

/// Returns outermost_at for the upper ends at the first or the last pose, evaluated in `station`.
template <class Side>
KERF_INLINE LaneMask upper_outermost_at(const Side& side, const SlicePath& path, const RayRow& row,
                                        const Station& station) {
  const Meeting upper = at_upper_end(side, path, row.x, row.y, station.share, station.met);
  return outermost_at(path, upper, station.share > 0 ? 1 : -1);
}

/// Returns the ends that are outermost at the first or the last pose, evaluated in `station`, and
/// those of rays without stock beyond them. The selection of ends that are found elsewhere, and
/// their positions, must not depend on the stock.
template <class Side>
KERF_INLINE KnownEnds known_at(const Side& side, const SlicePath& path, const RayRow& row,
                               const Station& station, LaneMask asked, const ColumnBlock& block) {
  const double sign = station.share > 0 ? 1 : -1;
  const Meeting& m = station.met;
  KnownEnds known;
  known.lower = m.hit & (outermost_at(path, m, sign) | (m.lo <= row.stock_lo));
  known.upper = m.hit & ((m.hi >= path.search.top_mm) | block.loses_all_above(row.number) |
                         (m.hi >= row.stock_hi));
  if (any(asked & known.lower & ~known.upper)) {
    known.upper |= upper_outermost_at(side, path, row, station);
  }
  return known;
}

/// Returns whether a row is ahead of the slice rather than behind it, so that its last pose is more
/// likely than its first to be all that it sweeps there.
KERF_INLINE bool is_ahead(const SlicePath& path, const RayRow& row) {
  const TurningFrame& f = path.frame;
  const double x = (row.x[0] + row.x[kLanes - 1]) * 0.5 - f.tip.x, y = row.y[0] - f.tip.y;
  return x * f.v.x + y * f.v.y >= 0;
}

/// Adds the intervals that a slice removes along its path to a row.
template <class Side>
KERF_INLINE void evaluate_row(const Side& side, const SlicePath& path, const RayRow& row,
                              LaneMask open, PackedRays& packed, ColumnBlock& block) {
  const int parts = path.search.parts;
  const double top = block.top_mm + block.join_mm;
  Stations stations;
  Station* ends[2];
  KnownEnds known{~every_lane(), ~every_lane()};
  Lanes reach =
      Lanes(0);  // the share in which no missed ray is hit, from the first evaluated pose on
  bool at_last = is_ahead(path, row);
  for (int k = 0; k < 2; ++k, at_last = !at_last) {
    Station& met = stations.add(side, path, row, at_last ? 1 : 0, 0, open);
    ends[at_last] = &met;
    const KnownEnds here = known_at(side, path, row, met, open, block);
    const LaneMask settled = open & here.both();
    if (any(settled)) {
      add_span(block, row.number, {met.met.lo, met.met.hi}, settled);
      open &= ~settled;
    }
    const LaneMask missed = open & ~met.met.hit;
    const double sign = at_last ? -1 : 1;
    Lanes beside = Lanes(0);
    if (any(missed)) {
      beside = select(missed, least_share(path, met.met, sign * met.met.advance, top, 1), beside);
      const LaneMask doubtful = missed & ~(beside + reach > 1.0);
      // A single part is searched anyway if the row has hits.
      if (any(doubtful) && (parts > 1 || !any(open & met.met.hit))) {
        const FoundEnd end = FoundEnd::of<End::kLower>(Lanes(met.share), met.met);
        const Lanes share =
            reach_beside(side, path, row.x, row.y, end, sign, Lanes(1), -kRecedingMm);
        beside = select(doubtful & (share > beside), share, beside);
      }
      open &= ~(beside + reach > 1.0);
    }
    if (!any(open)) return;
    reach = beside;
    known = {known.lower | here.lower, known.upper | here.upper};
  }
  // Both ends are known, and the intervals of both poses overlap, so nothing else is swept.
  const Meeting &from = ends[0]->met, &to = ends[1]->met;
  LaneMask ends_known =
      open & known.lower & from.hit & to.hit & (from.lo <= to.hi) & (to.lo <= from.hi);
  if (any(ends_known & ~known.upper)) {
    known.upper |= upper_outermost_at(side, path, row, *ends[0]) |
                   upper_outermost_at(side, path, row, *ends[1]);
  }
  ends_known &= known.upper;
  if (any(ends_known)) {
    add_span(block, row.number, {lesser(from.lo, to.lo), greater(from.hi, to.hi)}, ends_known);
    open &= ~ends_known;
    if (!any(open)) return;
  }
  Station* first = ends[0];
  ends[1]->asked = open;
  for (int part = 1; part <= parts; ++part) {
    const double share = double(part) / parts;
    stations.push(part == parts ? *ends[1] : stations.add(side, path, row, share, 0, open));
    first = &evaluate_stretch(side, path, row, first, stations, packed, block);
  }
}

/// Adds the intervals of the rows that need no search, and removes them from the rows to be
/// evaluated.
template <class Side>
KERF_INLINE void add_simple_rows(const Side& side, const SlicePath& path, const RowBits& known,
                                 ColumnBlock& block) {
  const Lanes x = block.x_mm;
  const bool has_discs = !path.discs.poses.empty();
  for (unsigned left = has_discs ? block.rows : known.ahead; left != 0; left &= left - 1) {
    const int row = __builtin_ctz(left);
    const Lanes y = block.y_mm[row];
    const LaneMask open = block.open(row);
    if (!has_discs || !add_disc_row(side, path, y, row, open, known, block)) {
      if ((known.ahead >> row & 1) == 0) continue;
      add_last_pose(side, path, {x, y, row, false, false, {}, {}}, open, block);
    }
    block.rows &= ~(1U << row);
  }
}

/// Adds the intervals that a slice removes along its path to the rows of a block.
template <class Side>
KERF_INLINE void evaluate_rows(const Side& side, const SlicePath& path, const RowBits& known,
                               ColumnBlock& block) {
  const Lanes x = block.x_mm;
  PackedMemory memory;
  PackedRays& packed = memory.empty();
  for (unsigned left = block.rows; left != 0; left &= left - 1) {
    const int row = __builtin_ctz(left);
    const Lanes y = block.y_mm[row];
    const bool hides_entry = (known.hides_entry >> row & 1) != 0;
    const bool hides_exit = (known.hides_exit >> row & 1) != 0;
    const Lanes &lo = block.stock_lo_mm[std::size_t(row)],
                &hi = block.stock_hi_mm[std::size_t(row)];
    const LaneMask open = block.open(row) & (lo < hi);
    if (!any(open)) continue;
    evaluate_row(side, path, {x, y, row, hides_entry, hides_exit, lo, hi}, open, packed, block);
  }
  search_rays(side, path, packed, true, block);
}

/// evaluate_rows and add_simple_rows, compiled for each instruction set, each in a unit of its own
/// (turning_unit.h).
KERF_DECLARE_TARGETS(void, evaluate_slice,
                     (const PieceSide& side, const SlicePath& path, const RowBits& known,
                      ColumnBlock& block))
KERF_DECLARE_TARGETS(void, add_simple_rows_of_slice,
                     (const PieceSide& side, const SlicePath& path, const RowBits& known,
                      ColumnBlock& block))

}  // namespace kerf
