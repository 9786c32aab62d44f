// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/span.h"
#include "kernel/sweep/miss_reach.h"
#include "kernel/sweep/slice_meeting.h"

namespace kerf {

KERF_INLINE void include_hits(LaneSpan& span, const Meeting& m) {
  span.lo = select(m.hit & (m.lo < span.lo), m.lo, span.lo);
  span.hi = select(m.hit & (m.hi > span.hi), m.hi, span.hi);
}

/// Includes the end of a hit. The search for upper ends does not change lower ones, which are final
/// and must not depend on whether upper ends are searched.
template <End end>
KERF_INLINE void include_end(LaneSpan& span, const Meeting& m) {
  if (end == End::kLower) {
    include_hits(span, m);
  } else {
    span.hi = select(m.hit & (m.hi > span.hi), m.hi, span.hi);
  }
}

/// Maximum number of steps of a search. It brackets the solution and stops when all lanes are done.
constexpr int kSearchSteps = 120;

/// Returns the lanes whose end is on the same surface, side or disc, as at a station.
KERF_INLINE LaneMask continues(const Meeting& m, const Meeting& station) {
  return m.hit & station.hit & ~(m.on_side ^ station.on_side);
}

/// Returns the rays that leave the slice through a disc at both stations, and in between farther
/// out by at most the tolerance. If a neighbor that is swept too hides the disc, their upper end
/// belongs to the neighbor too, and need not be searched.
KERF_INLINE LaneMask leaves_by_disc(const SlicePath& path, const Stretch& stretch) {
  const Meeting &first = stretch.first, &last = stretch.last;
  return first.hit & last.hit & ~first.leaves_side & ~last.leaves_side &
         held_by_disc(path, magnitude(first.hi - last.hi), stretch.to - stretch.from);
}
/// As leaves_by_disc, for the lower ends.
KERF_INLINE LaneMask enters_by_disc(const SlicePath& path, const Stretch& stretch) {
  const Meeting &first = stretch.first, &last = stretch.last;
  return first.hit & last.hit & ~first.enters_side & ~last.enters_side &
         held_by_disc(path, magnitude(first.lo - last.lo), stretch.to - stretch.from);
}

/// The quantity that is searched in each lane. At most one of the masks is set.
struct Searches {
  LaneMask turn;   ///< the share at which the advance changes from > 0 to < 0
  LaneMask first;  ///< the last share up to which the ray's end, from the first station on, stays
                   ///< on its surface and moves outwards
  LaneMask last;   ///< the first share from which the same holds backwards from the last station
  LaneMask edge;   ///< the share at which the piece begins or ceases to hit the ray

  KERF_INLINE LaneMask all() const { return turn | first | last | edge; }
};

/// Returns the searches of a stretch. If the end moves outwards at the first station and inwards at
/// the last, the outermost end is in between. It may also be in between if the end changes surface:
/// at the edge where the first surface ends or the last begins, or, if the speed changes sign in
/// between, at the edge of the piece.
KERF_INLINE Searches searches_of(const SlicePath& path, const Stretch& stretch, LaneMask asked) {
  const Meeting &first = stretch.first, &last = stretch.last;
  const LaneMask outwards = first.advance > 0.0, inwards = last.advance < 0.0;
  const LaneMask changes = asked & ~continues(first, last);
  Searches s;
  s.turn = asked & outwards & inwards;
  s.first = changes & outwards & ~inwards & first.hit;
  s.last = changes & inwards & ~outwards & last.hit;
  s.edge = ~every_lane();
  if (path.search.shows_disc) {
    s.edge = asked & ((first.hit & ~last.hit & ~outwards) | (last.hit & ~first.hit & ~inwards));
  }
  return s;
}

/// The functions of which one is zero at the searched share, evaluated at one end of the bracket.
struct Sought {
  Lanes advance, within, through;

  KERF_INLINE explicit Sought(const Meeting& m)
      : advance(m.advance), within(m.within), through(m.through) {}
  /// Replaces the values by those of `m` in the lanes `moved`, and halves them in the lanes
  /// `stayed`, so that the other end of the bracket moves too (Illinois).
  KERF_INLINE void move(LaneMask moved, LaneMask stayed, const Meeting& m) {
    const Lanes share = select(stayed, Lanes(0.5), Lanes(1));
    advance = select(moved, m.advance, advance * share);
    within = select(moved, m.within, within * share);
    through = select(moved, m.through, through * share);
  }
};

/// Returns the zero of the straight line between a and b: of `through` if the ray is hit at only
/// one of them, of `within` if its end changes between side and disc, else of `advance`.
KERF_INLINE Lanes falsi(Lanes a, Lanes b, const Sought& fa, const Sought& fb) {
  const LaneMask enters = fa.through * fb.through < 0.0, crosses = fa.within * fb.within < 0.0;
  const Lanes f = select(enters, fa.through, select(crosses, fa.within, fa.advance));
  const Lanes g = select(enters, fb.through, select(crosses, fb.within, fb.advance));
  return a + (b - a) * (f / (f - g));
}

/// The evaluated shares nearest to the searched one.
struct Bracket {
  FoundEnd earlier, later;
};

/// Searches a stretch by regula falsi in the Illinois variant with bisections. Every hit at an
/// evaluated share widens `span`. Returns the bracket.
template <End end, class Side>
KERF_INLINE Bracket search(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                           const Stretch& stretch, const Searches& what, LaneSpan& span) {
  Lanes a = stretch.from, b = stretch.to;
  Sought fa(stretch.first), fb(stretch.last);
  LaneMask was_later = ~every_lane(), was_earlier = was_later;
  const Lanes travel = (stretch.to - stretch.from) * path.speed_max_mm;
  Lanes length = stretch.to - stretch.from;
  LaneMask searching = what.all() & (stretch.first.clearance + stretch.last.clearance <= travel);
  Bracket bracket{FoundEnd::of<end>(a, stretch.first), FoundEnd::of<end>(b, stretch.last)};
  for (int i = 0; i < kSearchSteps && any(searching); ++i) {
    const Lanes guess = falsi(a, b, fa, fb);
    LaneMask usable = (guess > a) & (guess < b);
    // Every third step bisects unless the bracket has become at most half as long.
    if (i % 3 == 2) {
      usable &= b - a <= 0.5 * length;
      length = b - a;
    }
    const Lanes s = select(usable, guess, (a + b) * 0.5);
    Meeting m = meet<end>(side, path, x, y, s);
    const LaneMask outwards = m.advance > 0.0, inwards = m.advance < 0.0;
    const LaneMask later = (what.turn & outwards) |
                           (what.first & outwards & continues(m, stretch.first)) |
                           (what.last & ~(inwards & continues(m, stretch.last))) |
                           (what.edge & ~(m.hit ^ stretch.first.hit));
    bracket.earlier.take(searching & later, FoundEnd::of<end>(s, m));
    bracket.later.take(searching & ~later, FoundEnd::of<end>(s, m));
    m.hit &= searching;
    include_end<end>(span, m);
    const LaneMask crosses = ~what.edge & (fa.within * fb.within < 0.0);
    const Lanes first_within = fa.within;
    fa.move(later, ~later & was_earlier, m);
    fb.move(~later, later & was_later, m);
    was_later = later;
    was_earlier = ~later;
    a = select(later, s, a);
    b = select(later, b, s);
    // By convexity the end moves along the ray at most at its present speed, and off the surface at
    // most as far as the piece moves. If it moves outwards on one of side and disc and inwards on
    // the other, it is outermost where the two meet, within the bracket.
    const Lanes left = select(later, b - s, s - a);
    const LaneMask as_first = m.within * first_within > 0.0;
    const LaneMask turns =
        (as_first & outwards & (m.beyond < 0.0)) | (~as_first & inwards & (m.beyond > 0.0));
    const LaneMask at_rim =
        m.hit & crosses & turns & (magnitude(m.within) <= path.search.search_mm);
    const LaneMask far =
        (magnitude(m.advance * left) > path.search.search_mm * magnitude(m.upright)) |
        (what.first & ~later) | (what.last & later) | what.edge;
    const Lanes reach = (b - a) * path.speed_max_mm;
    searching &= far & ~at_rim & (reach > path.search.search_mm) & (m.clearance <= reach);
  }
  return bracket;
}

/// Returns the rays that stay inside the side of a round slice, continued beyond its discs, and end
/// on it at both stations: each has a single outermost end there.
KERF_INLINE LaneMask has_one_end(const SlicePath& path, const Stretch& stretch) {
  if (path.search.checked) return ~every_lane();
  const Meeting &first = stretch.first, &last = stretch.last;
  return first.on_side & last.on_side & (first.side_lo <= last.side_hi) &
         (last.side_lo <= first.side_hi);
}

/// Returns the rays that may have ends farther out by more than the tolerance, because neither a
/// round side nor a disc excludes it.
template <End end>
KERF_INLINE LaneMask needs_reach(const SlicePath& path, const Stretch& stretch) {
  const Meeting &first = stretch.first, &last = stretch.last;
  const Lanes apart = end == End::kLower ? first.lo - last.lo : first.hi - last.hi;
  const LaneMask on_disc = ~first.on_side & ~last.on_side;
  const LaneMask held = on_disc & held_by_disc(path, magnitude(apart), stretch.to - stretch.from);
  return ~(first.hit & last.hit & (held | has_one_end(path, stretch)));
}

/// Returns the rays among `asked` whose outermost end may be between the stations: search_stretch
/// must be called for them. `span` holds the ends at the stations.
template <End end, class Side>
KERF_INLINE LaneMask needs_search(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                                  const Stretch& stretch, LaneMask asked, const LaneSpan& span) {
  const LaneMask searched = searches_of(path, stretch, asked).all();
  if (!(path.frame.turn > 0)) return searched;
  LaneMask doubtful = asked & ~searched & needs_reach<end>(path, stretch);
  if (!any(doubtful)) return searched;
  const Lanes best = end == End::kLower ? span.lo : span.hi;
  doubtful &= ~plainly_covered<end>(path, stretch, best);
  if (!any(doubtful)) return searched;
  return searched | (doubtful & gap_of<end>(side, path, x, y, stretch, best, doubtful).open());
}

/// Number of ends by which a gap is closed before the depth that may be missed is doubled, number
/// of further ends before it is doubled again, and the maximum of all, which is never reached
/// (kernel/sweep/bounds.md, "It ends").
constexpr int kGapSteps = 32, kMoreGapSteps = 4, kGapStepsMax = 1 << 12;

/// Evaluates the rays `open` at shares within a gap until the reaches of their ends cover it, and
/// includes these ends in `span`. Each end whose reach adjoins the covered shares narrows the gap.
/// The evaluated share approaches the covered ones until that happens. Returns the number of
/// evaluations.
template <End end, class Side>
KERF_INLINE int close_gap(const Side& side, const SlicePath& path, Lanes x, Lanes y, Lanes length,
                          Gap gap, LaneMask open, LaneSpan& span) {
  Lanes at = (gap.low + gap.high) * 0.5;
  double depth = tolerance_of(path);
  int steps = 0;
  for (; steps < kGapStepsMax && any(open); ++steps) {
    if (steps >= kGapSteps && (steps - kGapSteps) % kMoreGapSteps == 0) depth *= 2;
    Meeting m = meet<end>(side, path, x, y, at);
    const FoundEnd found = FoundEnd::of<end>(at, m);
    m.hit &= open;
    include_end<end>(span, m);
    const Lanes best = end == End::kLower ? span.lo : span.hi;
    const LaneMask closed = close<end>(side, path, x, y, gap, found, best, length, depth);
    at = select(closed, gap.low + gap.high, gap.low + at) * 0.5;
    open &= gap.open();
  }
  return steps;
}

/// Returns the gap that the stations and the search leave in the rays `asked`.
template <End end, class Side>
KERF_INLINE Gap gap_after(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                          const Stretch& stretch, const Bracket& found, LaneMask asked,
                          Lanes best) {
  const Lanes length = stretch.to - stretch.from;
  Gap gap = gap_of<end>(side, path, x, y, stretch, best, asked);
  // The second end of the bracket may adjoin shares that the first one could not.
  for (int k = 0; k < 3 && any(asked & gap.open()); ++k) {
    close<end>(side, path, x, y, gap, k == 1 ? found.later : found.earlier, best, length,
               tolerance_of(path));
  }
  return gap;
}

/// Widens `span` by the outermost end between two stations, up to the tolerance. If the ends found
/// do not rule out one farther out, more shares are evaluated, and their number is returned.
template <End end, class Side>
KERF_INLINE int search_stretch(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                               const Stretch& stretch, LaneMask asked, LaneSpan& span) {
  const Searches what = searches_of(path, stretch, asked);
  const Bracket found = search<end>(side, path, x, y, stretch, what, span);
  if (!(path.frame.turn > 0)) return 0;
  asked &= needs_reach<end>(path, stretch);
  if (!any(asked)) return 0;
  const Lanes best = end == End::kLower ? span.lo : span.hi;
  const Gap gap = gap_after<end>(side, path, x, y, stretch, found, asked, best);
  return close_gap<end>(side, path, x, y, stretch.to - stretch.from, gap, asked & gap.open(), span);
}

}  // namespace kerf
