// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kernel/math/span.h"
#include "kernel/sweep/slice_meeting.h"

namespace kerf {

KERF_INLINE void include_hits(LaneSpan& span, const Meeting& m) {
  span.lo = select(m.hit & (m.lo < span.lo), m.lo, span.lo);
  span.hi = select(m.hit & (m.hi > span.hi), m.hi, span.hi);
}

/// Includes the end of a hit. The search for upper ends does not change lower ones: those are final
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

/// Intervals of shares between two stations, and the intersections there.
struct Stretch {
  Lanes from, to;
  const Meeting &first, &last;
};

/// Returns where the end is on the same surface, side or disc, as at a station.
KERF_INLINE LaneMask continues(const Meeting& m, const Meeting& station) {
  return m.hit & station.hit & ~(m.on_side ^ station.on_side);
}

/// Returns the rays that leave the slice through a disc at both stations. If a neighbor that is
/// swept too hides it, they go on in the neighbor, which they enter there, so no upper end has to
/// be searched.
KERF_INLINE LaneMask leaves_by_disc(const Stretch& stretch) {
  const Meeting &first = stretch.first, &last = stretch.last;
  return first.hit & last.hit & ~first.leaves_side & ~last.leaves_side;
}
/// The same for the lower ends.
KERF_INLINE LaneMask enters_by_disc(const Stretch& stretch) {
  const Meeting &first = stretch.first, &last = stretch.last;
  return first.hit & last.hit & ~first.enters_side & ~last.enters_side;
}

/// The quantity that is searched in each lane; at most one of the masks is set.
struct Searches {
  LaneMask turn;   ///< the share at which the advance changes from > 0 to < 0
  LaneMask first;  ///< the last share up to which the ray's end, from the first station on, stays
                   ///< on its surface and moves outwards
  LaneMask last;   ///< the first share from which the same holds backwards from the last station
  LaneMask edge;   ///< the share at which the piece begins or ceases to hit the ray

  KERF_INLINE LaneMask all() const { return turn | first | last | edge; }
};

/// Returns the searches of a stretch. If the end moves outwards at the first station and inwards at
/// the last, the outermost end lies in between. It may also lie in between if the end changes
/// surface: at the edge where the first surface ends or the last begins, or, if the speed changes
/// sign in between, at the edge of the piece.
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

/// Functions one of which is zero at the searched share, evaluated at one end of the bracket.
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

/// Searches a stretch by regula falsi in the Illinois variant with bisections. Every hit at an
/// evaluated share widens `span`. Returns the last shares.
template <End end, class Side>
KERF_INLINE Lanes search(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                         const Stretch& stretch, const Searches& what, LaneSpan& span) {
  Lanes a = stretch.from, b = stretch.to;
  Sought fa(stretch.first), fb(stretch.last);
  LaneMask was_later = ~every_lane(), was_earlier = was_later;
  const Lanes travel = (stretch.to - stretch.from) * path.speed_max_mm;
  Lanes length = stretch.to - stretch.from;
  LaneMask searching = what.all() & (stretch.first.clearance + stretch.last.clearance <= travel);
  Lanes at = a;
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
    at = select(searching, s, at);
    const LaneMask outwards = m.advance > 0.0, inwards = m.advance < 0.0;
    const LaneMask later = (what.turn & outwards) |
                           (what.first & outwards & continues(m, stretch.first)) |
                           (what.last & ~(inwards & continues(m, stretch.last))) |
                           (what.edge & ~(m.hit ^ stretch.first.hit));
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
    // most as far as the piece moves. Where it moves outwards on one of side and disc and inwards
    // on the other, it is outermost where the two meet, within the bracket.
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
  return at;
}

/// Returns a lower bound, by convexity, of the distance between the piece and the point of a ray at
/// the height `best`, `share` away from a station. At the station the ray's end is at `z` and moves
/// outwards by `advance` towards that share (kernel/sweep/README.md, "The tight model").
KERF_INLINE Lanes least_off(const SlicePath& path, const Meeting& m, Lanes z, Lanes best,
                            Lanes advance, Lanes share) {
  const Lanes scale = 1 / square_root(m.normal2);
  const Lanes rise = magnitude(z - best);
  const Lanes fall = greater(advance, Lanes(0)) * scale + path.frame.turn * rise;
  return magnitude(m.upright) * scale * rise - (fall + 0.5 * path.search.bend_mm * share) * share;
}

/// Returns the rays whose extremum may exceed `best`, found at the share `at`, by more than
/// `missed_mm`. Near `at` the bend excludes it; near the stations, the bounds from there do.
template <End end>
KERF_INLINE LaneMask doubtful(const SlicePath& path, const Stretch& stretch, Lanes at, Lanes best,
                              double covered) {
  const Meeting &first = stretch.first, &last = stretch.last;
  const Lanes left = at - covered - stretch.from, right = stretch.to - covered - at;
  const Lanes z0 = end == End::kLower ? first.lo : first.hi;
  const Lanes z1 = end == End::kLower ? last.lo : last.hi;
  const Lanes missed = -path.search.missed_mm;
  return ((left > 0.0) & ~(least_off(path, first, z0, best, first.advance, left) >= missed)) |
         ((right > 0.0) & ~(least_off(path, last, z1, best, -last.advance, right) >= missed));
}

/// The rays of a stretch in which an end may lie farther out than the one found.
struct Doubts {
  LaneMask checked;  ///< the bend is so large that the first bound does not cover the stretch
  double covered;    ///< share around a stationary end within which nothing deeper is missed
};
KERF_INLINE Doubts doubts_of(const SlicePath& path, const Stretch& stretch) {
  const double covered = std::sqrt(2 * path.search.missed_mm / path.search.bend_mm);
  const LaneMask longer = Lanes(covered) < stretch.to - stretch.from;
  return {path.search.checked ? longer : ~every_lane(), covered};
}

/// Returns the rays of a stretch that remain doubtful, where `found` is the share of the end that
/// was searched and `span` the outermost end.
template <End end>
KERF_INLINE LaneMask remaining_doubts(const SlicePath& path, const Stretch& stretch,
                                      const Doubts& doubts, LaneMask turn, Lanes found,
                                      const LaneSpan& span) {
  const Meeting &first = stretch.first, &last = stretch.last;
  const LaneMask at_first = end == End::kLower ? first.lo < last.lo : first.hi > last.hi;
  const Lanes station = select(at_first, stretch.from, stretch.to);
  const Lanes best = end == End::kLower ? span.lo : span.hi;
  return doubts.checked & first.hit & last.hit &
         doubtful<end>(path, stretch, select(turn, found, station), best, doubts.covered);
}

/// Returns the rays among `asked` whose outermost end may lie between the stations: search_stretch
/// must be called for them. `span` holds the ends at the stations.
template <End end>
KERF_INLINE LaneMask needs_search(const SlicePath& path, const Stretch& stretch, LaneMask asked,
                                  const LaneSpan& span) {
  const LaneMask searched = searches_of(path, stretch, asked).all();
  const Doubts doubts = doubts_of(path, stretch);
  if (!any(doubts.checked)) return searched;
  return searched |
         (asked & remaining_doubts<end>(path, stretch, doubts, ~every_lane(), stretch.from, span));
}

/// Widens `span` by the outermost end between two stations, up to `missed_mm`. A stretch that
/// remains doubtful is bisected once: its halves bend so little that no doubt remains.
template <End end, class Side>
KERF_INLINE void search_stretch(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                                const Stretch& stretch, LaneMask asked, LaneSpan& span) {
  const Meeting &first = stretch.first, &last = stretch.last;
  const Lanes share = (stretch.from + stretch.to) * 0.5;
  const Doubts doubts = doubts_of(path, stretch);
  const bool checked = any(doubts.checked);
  Meeting middle;
  const Stretch stretches[] = {
      stretch, {stretch.from, share, first, middle}, {share, stretch.to, middle, last}};
  for (int k = 0; k < (checked ? 3 : 1); ++k) {
    const Searches what = searches_of(path, stretches[k], asked);
    const Lanes found = search<end>(side, path, x, y, stretches[k], what, span);
    if (!checked || k > 0) continue;
    asked &= remaining_doubts<end>(path, stretch, doubts, what.turn, found, span);
    if (!any(asked)) return;
    middle = meet<end>(side, path, x, y, share);
    Meeting asked_only = middle;
    asked_only.hit &= asked;
    include_end<end>(span, asked_only);
  }
}

}  // namespace kerf
