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

/// The search for the upper ends leaves the lower ones alone: they are done with, and must not
/// depend on whether it is needed.
template <End end>
KERF_INLINE void include_end(LaneSpan& span, const Meeting& m) {
  if (end == End::kLower) {
    include_hits(span, m);
  } else {
    span.hi = select(m.hit & (m.hi > span.hi), m.hi, span.hi);
  }
}

/// Steps of a search; it brackets the solution and stops as soon as every lane is done.
constexpr int kSearchSteps = 120;

/// The shares between two stations, and what was met there.
struct Stretch {
  double from, to;
  const Meeting &first, &last;
};

KERF_INLINE LaneMask continues(const Meeting& m, const Meeting& station) {
  return m.hit & station.hit & ~(m.on_side ^ station.on_side);
}

/// What is searched in which lanes, one thing in each.
struct Searches {
  LaneMask turn;   ///< the one place where the advance changes from > 0 to < 0
  LaneMask first;  ///< the end of what the ray's end does from the first station on: it stays on
                   ///< its surface and moves outwards
  LaneMask last;   ///< the begin of what it does up to the last station
  LaneMask edge;   ///< where the piece meets or leaves the ray

  KERF_INLINE LaneMask all() const { return turn | first | last | edge; }
};

/// The outermost end lies between two stations where the end moves outwards at the first and
/// inwards at the last. Elsewhere it may do so too if it changes surface: up to the edge where the
/// first surface ends, or from the edge where the last begins; or, having turned round in between,
/// at the very edge of the piece.
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

/// What is zero at the place that is searched, as far as is known at one side of it.
struct Sought {
  Lanes advance, within, through;

  KERF_INLINE explicit Sought(const Meeting& m)
      : advance(m.advance), within(m.within), through(m.through) {}
  /// In the lanes `moved` that is `m` now; in the lanes `stayed` it counts half, so that the other
  /// side moves too.
  KERF_INLINE void move(LaneMask moved, LaneMask stayed, const Meeting& m) {
    const Lanes share = select(stayed, Lanes(0.5), Lanes(1));
    advance = select(moved, m.advance, advance * share);
    within = select(moved, m.within, within * share);
    through = select(moved, m.through, through * share);
  }
};

/// Where between a and b a straight line is zero: from the one to the other the ray is missed or
/// met, or its end changes between side and disc, or else it turns round.
KERF_INLINE Lanes falsi(Lanes a, Lanes b, const Sought& fa, const Sought& fb) {
  const LaneMask enters = fa.through * fb.through < 0.0, crosses = fa.within * fb.within < 0.0;
  const Lanes f = select(enters, fa.through, select(crosses, fa.within, fa.advance));
  const Lanes g = select(enters, fb.through, select(crosses, fb.within, fb.advance));
  return a + (b - a) * (f / (f - g));
}

/// Searches a stretch: regula falsi in the Illinois variant with halvings. Every hit on the way
/// widens `span`. Returns where it ended.
template <End end, class Side>
KERF_INLINE Lanes search(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                         const Stretch& stretch, const Searches& what, LaneSpan& span) {
  Lanes a = Lanes(stretch.from), b = Lanes(stretch.to);
  Sought fa(stretch.first), fb(stretch.last);
  LaneMask was_later = ~every_lane(), was_earlier = was_later;
  const Lanes way = (stretch.to - stretch.from) * path.speed_max_mm;
  Lanes length = stretch.to - stretch.from;
  LaneMask searching = what.all() & (stretch.first.clearance + stretch.last.clearance <= way);
  Lanes at = a;
  for (int i = 0; i < kSearchSteps && any(searching); ++i) {
    const Lanes guess = falsi(a, b, fa, fb);
    LaneMask usable = (guess > a) & (guess < b);
    // Every third step sees whether the stretch has become half as long, and halves it if not.
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
    // By convexity the end cannot move farther along the ray than at its present speed, nor off the
    // surface than the piece moves at all. Where it goes outwards on the one of side and disc and
    // inwards on the other, it is outermost where they meet: between the two.
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

/// How far at least the point of a ray at the height `best` is off the piece, `share` away from a
/// station: there the ray's end is at `z` and moves outwards by `advance` towards that share. What
/// convexity leaves (kernel/README.md, "The tight model").
KERF_INLINE Lanes least_off(const SlicePath& path, const Meeting& m, Lanes z, Lanes best,
                            Lanes advance, Lanes share) {
  const Lanes scale = 1 / square_root(m.normal2);
  const Lanes rise = magnitude(z - best);
  const Lanes fall = greater(advance, Lanes(0)) * scale + path.frame.turn * rise;
  return magnitude(m.upright) * scale * rise - (fall + 0.5 * path.search.bend_mm * share) * share;
}

/// Rays that may reach farther out than `best`, found at the share `at`, by more than what may be
/// missed: near `at` the bend forbids it, and near the stations what is known there.
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

/// Widens `span` by the outermost end between two stations, to within what may be missed. A stretch
/// that leaves a doubt is halved, once: its halves bend little enough to leave none.
template <End end, class Side>
KERF_INLINE void search_stretch(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                                const Stretch& stretch, LaneMask asked, LaneSpan& span) {
  const Meeting &first = stretch.first, &last = stretch.last;
  const double length = stretch.to - stretch.from, share = (stretch.from + stretch.to) * 0.5;
  const double covered = std::sqrt(2 * path.search.missed_mm / path.search.bend_mm);
  const bool checked = path.search.checked && covered < length;
  Meeting middle;
  const Stretch stretches[] = {
      stretch, {stretch.from, share, first, middle}, {share, stretch.to, middle, last}};
  for (int k = 0; k < (checked ? 3 : 1); ++k) {
    const Searches what = searches_of(path, stretches[k], asked);
    const Lanes found = search<end>(side, path, x, y, stretches[k], what, span);
    if (!checked || k > 0) continue;
    const LaneMask at_first = end == End::kLower ? first.lo < last.lo : first.hi > last.hi;
    const Lanes station = select(at_first, Lanes(stretch.from), Lanes(stretch.to));
    const Lanes best = end == End::kLower ? span.lo : span.hi;
    asked &= first.hit & last.hit &
             doubtful<end>(path, stretch, select(what.turn, found, station), best, covered);
    if (!any(asked)) return;
    middle = meet<end>(side, path, x, y, share);
    Meeting seen = middle;
    seen.hit &= asked;
    include_end<end>(span, seen);
  }
}

}  // namespace kerf
