#include "kernel/sweep/turning_sweep.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

using Path = TurningSweep::Path;

/// Which end of a ray's interval is searched.
enum class End { kLower, kUpper };

/// Steps of a search; it brackets the solution and stops as soon as every lane is done.
constexpr int kSearchSteps = 120;

/// Sine from which on a ray is steep to the discs of the piece, so that they say better than the
/// side how far apart the two are.
constexpr double kSteep = 0.5;

/// A piece at eight shares, met by eight rays.
struct Meeting {
  Lanes lo, hi;  ///< heights of the interval, relative to the middle tip
  LaneMask hit;
  LaneMask on_side;  ///< of hits: the end lies on the side, not on a disc
  /// > 0: later in the motion the end lies farther out, or the piece is nearer to the ray; < 0: it
  /// was so earlier.
  Lanes advance;
  Lanes clearance;  ///< of a ray that is missed: the least distance, 0 where it is not known
  Lanes upright;    ///< advance / upright is how fast the end moves along the ray; 0 where missed
};

/// `x`, `y` relative to the middle tip.
template <End end, class Side>
KERF_INLINE Meeting meet(const Side& side, const Path& path, Lanes x, Lanes y, Lanes share) {
  const TurningFrame::Poses pose = path.frame.at(share);
  const Vec3Lanes& u = pose.u;
  const Vec3Lanes anchor = u * Lanes(side.anchor);
  const Lanes px = x - (pose.tip.x + anchor.x), py = y - (pose.tip.y + anchor.y);
  const Lanes along = px * u.x + py * u.y;
  const SideSpan span = side.meet(px, py, u, along);

  // A ray at right angles to the axis never crosses the discs: they are far away.
  const Lanes uz = select(magnitude(u.z) > 1e-290, u.z, Lanes(1e-290));
  const Lanes to_low = (side.low - along) / uz, to_high = (side.high - along) / uz;
  const Lanes disc_in = lesser(to_low, to_high), disc_out = greater(to_low, to_high);
  const LaneMask below = span.exists & (span.out < disc_in);
  const LaneMask above = span.exists & (span.in > disc_out);
  const LaneMask hit = span.exists & ~below & ~above;
  const Lanes in = greater(span.in, disc_in), out = lesser(span.out, disc_out);

  // The one point that decides: of the end, or where side and discs come closest to meeting.
  const LaneMask steep = magnitude(u.z) >= kSteep;
  const LaneMask on_side = end == End::kLower ? span.in >= disc_in : span.out <= disc_out;
  Lanes t = select(span.exists, select(below, span.out, span.in), span.closest);
  t = select(steep, lesser(greater(t, disc_in), disc_out), t);
  t = select(hit, end == End::kLower ? in : out, t);
  const Vec3Lanes p{px, py, t};
  const Lanes l = along + u.z * t;
  const Vec3Lanes n = side.normal(p, l, u);
  const Vec3Lanes v = path.frame.velocity(anchor + p);
  const Lanes side_speed = dot(n, v), axis_speed = dot(u, v);
  const Lanes outward = end == End::kLower ? -axis_speed : axis_speed;
  const Lanes disc_speed = select(u.z < 0.0, -outward, outward);
  // A miss: how fast the gap closes, seen from the nearer disc or from the side's end.
  const Lanes from_disc = side_speed - n.z * axis_speed / uz;
  const Lanes rise = select(span.exists, u.z * side_speed / n.z, Lanes(0)) - axis_speed;
  const Lanes from_side = select(span.exists, select(l < side.low, rise, -rise), side_speed);
  const Lanes gap_speed = select(steep, from_disc, from_side);

  Meeting m;
  m.hit = hit;
  m.on_side = on_side;
  m.lo = pose.tip.z + anchor.z + in;
  m.hi = pose.tip.z + anchor.z + out;
  m.advance = select(hit, select(on_side, side_speed, disc_speed), gap_speed);
  // The piece is at least this far from the ray, where that is known.
  const LaneMask passes = ~span.exists & (t == span.closest);
  m.clearance = select(passes, side.clearance(p, l, u), Lanes(0));
  m.upright = select(hit, select(on_side, n.z, u.z), Lanes(0));
  return m;
}

KERF_INLINE void include_hits(LaneSpan& span, const Meeting& m) {
  span.lo = select(m.hit & (m.lo < span.lo), m.lo, span.lo);
  span.hi = select(m.hit & (m.hi > span.hi), m.hi, span.hi);
}

/// The shares between two stations, and what was met there.
struct Stretch {
  double from, to;
  Meeting first, last;
};

/// Where a search looks: for the one place where the advance changes from > 0 to < 0; for the end
/// of what the end of the ray's interval does from the first station on (it stays on its surface
/// and moves outwards); for the begin of what it does up to the last station; or for where the
/// piece meets or leaves the ray.
enum class Branch { kWhole, kFirst, kLast, kEdge };

KERF_INLINE LaneMask continues(const Meeting& m, const Meeting& station) {
  return m.hit & station.hit & ~(m.on_side ^ station.on_side);
}

/// Searches a stretch in the lanes `searching`: regula falsi in the Illinois variant with
/// halvings, halving alone where the surface changes. Every hit on the way widens `span`.
template <End end, Branch branch, class Side>
KERF_INLINE void search(const Side& side, const Path& path, Lanes x, Lanes y,
                        const Stretch& stretch, LaneMask searching, LaneSpan& span) {
  Lanes a = Lanes(stretch.from), b = Lanes(stretch.to);
  Lanes fa = stretch.first.advance, fb = stretch.last.advance;
  const Lanes way = (stretch.to - stretch.from) * path.speed_max_mm;
  Lanes length = stretch.to - stretch.from;
  searching &= (stretch.first.clearance <= way) & (stretch.last.clearance <= way);
  for (int i = 0; i < kSearchSteps && any(searching); ++i) {
    Lanes s = (a + b) * 0.5;
    if (branch == Branch::kWhole) {
      const Lanes falsi = a + (b - a) * (fa / (fa - fb));
      LaneMask usable = (falsi > a) & (falsi < b);
      // Every third step sees whether the stretch has become half as long, and halves it if not.
      if (i % 3 == 2) {
        usable &= b - a <= 0.5 * length;
        length = b - a;
      }
      s = select(usable, falsi, s);
    }
    Meeting m = meet<end>(side, path, x, y, s);
    LaneMask later = m.advance > 0.0;
    if (branch == Branch::kFirst) later &= continues(m, stretch.first);
    if (branch == Branch::kLast) later = ~(continues(m, stretch.last) & (m.advance < 0.0));
    if (branch == Branch::kEdge) later = ~(m.hit ^ stretch.first.hit);
    m.hit &= searching;
    if (end == End::kLower) {
      include_hits(span, m);
    } else {
      // The lower end is done with, and must not depend on whether this search is needed.
      span.hi = select(m.hit & (m.hi > span.hi), m.hi, span.hi);
    }
    fa = select(later, m.advance, fa * 0.5);
    fb = select(later, fb * 0.5, m.advance);
    a = select(later, s, a);
    b = select(later, b, s);
    // By convexity the end cannot move farther along the ray than at its present speed, nor off the
    // surface than the piece moves at all.
    const Lanes left = select(later, b - s, s - a);
    LaneMask far = magnitude(m.advance * left) > path.search_mm * magnitude(m.upright);
    if (branch == Branch::kFirst) far |= ~later;
    if (branch == Branch::kLast) far |= later;
    if (branch == Branch::kEdge) far = every_lane();
    const Lanes reach = (b - a) * path.speed_max_mm;
    searching &= far & (reach > path.search_mm) & (m.clearance <= reach);
  }
}

/// Looks for the outermost end between two stations. It lies between them where the end moves
/// outwards at the first and inwards at the last. Elsewhere it may do so too if it changes surface:
/// up to the edge where the first surface ends, or from the edge where the last begins; or, having
/// turned round in between, at the very edge of the piece.
template <End end, class Side>
KERF_INLINE void search_stretch(const Side& side, const Path& path, Lanes x, Lanes y,
                                const Stretch& stretch, LaneMask asked, LaneSpan& span) {
  const Meeting &first = stretch.first, &last = stretch.last;
  const LaneMask outwards = first.advance > 0.0, inwards = last.advance < 0.0;
  const LaneMask changes = asked & ~continues(first, last);
  search<end, Branch::kWhole>(side, path, x, y, stretch, asked & outwards & inwards, span);
  search<end, Branch::kFirst>(side, path, x, y, stretch, changes & outwards & ~inwards & first.hit,
                              span);
  search<end, Branch::kLast>(side, path, x, y, stretch, changes & inwards & ~outwards & last.hit,
                             span);
  if (!path.shows_disc) return;
  search<end, Branch::kEdge>(
      side, path, x, y, stretch,
      asked & ((first.hit & ~last.hit & ~outwards) | (last.hit & ~first.hit & ~inwards)), span);
}

/// What the piece sweeps of the rays `asked` between two stations. The upper end is looked for
/// where it lies below `top`.
template <class Side>
KERF_INLINE LaneSpan sweep_stretch(const Side& side, const Path& path, Lanes x, Lanes y,
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

/// Adds what the piece sweeps between two stations to a row. Where a ray is inside at both, but
/// apart, and not in between, the piece has left it on one side and come back on the other, as a
/// disc does that turns about its diameter: each half has its own interval.
template <class Side>
KERF_INLINE void evaluate_stretch(const Side& side, const Path& path, Lanes x, Lanes y,
                                  const Stretch& stretch, LaneMask open, int row,
                                  ColumnBlock& block) {
  const Meeting &first = stretch.first, &last = stretch.last;
  const double z = path.frame.tip.z, top = block.top_mm - z;
  LaneMask gap = first.hit & last.hit & ((first.lo > last.hi) | (last.lo > first.hi));
  if (any(gap)) {
    const double share = (stretch.from + stretch.to) * 0.5;
    const Meeting middle = meet<End::kLower>(side, path, x, y, share);
    gap &= ~middle.hit;
    const Stretch before{stretch.from, share, first, middle};
    const Stretch after{share, stretch.to, middle, last};
    add_span(block, row, z, sweep_stretch(side, path, x, y, before, gap & open, top), gap);
    add_span(block, row, z, sweep_stretch(side, path, x, y, after, gap & open, top), gap);
  }
  add_span(block, row, z, sweep_stretch(side, path, x, y, stretch, ~gap & open, top), ~gap);
}

template <class Side>
KERF_INLINE void evaluate_rows(const Side& side, const Path& path, ColumnBlock& block) {
  const Lanes x = block.x_mm - path.frame.tip.x;
  for (int row = 0; row < kBlockSide; ++row) {
    if ((block.rows >> row & 1) == 0) continue;
    const Lanes y = block.y_mm[row] - path.frame.tip.y;
    const LaneMask open = block.open(row);
    Meeting from = meet<End::kLower>(side, path, x, y, 0);
    for (int part = 0; part < path.parts; ++part) {
      const double share_a = double(part) / path.parts;
      const double share_b = double(part + 1) / path.parts;
      const Meeting to = meet<End::kLower>(side, path, x, y, share_b);
      evaluate_stretch(side, path, x, y, {share_a, share_b, from, to}, open, row, block);
      from = to;
    }
  }
}

KERF_INLINE void evaluate_cone_in_lanes(const ConeSide& side, const Path& path,
                                        ColumnBlock& block) {
  evaluate_rows(side, path, block);
}
KERF_FOR_EACH_TARGET(void, evaluate_cone,
                     (const ConeSide& side, const Path& path, ColumnBlock& block),
                     (side, path, block))
KERF_INLINE void evaluate_arc_in_lanes(const ArcSide& side, const Path& path, ColumnBlock& block) {
  evaluate_rows(side, path, block);
}
KERF_FOR_EACH_TARGET(void, evaluate_arc,
                     (const ArcSide& side, const Path& path, ColumnBlock& block),
                     (side, path, block))

Path make_path(const Envelope& e, const ToolPose& from, const ToolPose& to, int parts,
               double search_mm, bool shows_disc) {
  const TurningFrame frame(from, to);
  const double radius = std::max(e.r_lo_mm, e.r_hi_mm);
  const double reach = std::sqrt(e.hi_mm * e.hi_mm + radius * radius);
  const double speed = length(frame.v) + frame.turn * reach;
  return {frame, parts, search_mm, speed > 0 ? speed : 1, shows_disc};
}

std::vector<ToolPose> stations(const Path& path, const ToolPose& from, const ToolPose& to) {
  const TurningFrame& f = path.frame;
  std::vector<ToolPose> poses{from};
  for (int i = 1; i < path.parts; ++i) {
    const TurningFrame::Poses at = f.at(Lanes(double(i) / path.parts));
    poses.push_back({f.tip + Vec3{at.tip.x[0], at.tip.y[0], at.tip.z[0]},
                     Vec3{at.u.x[0], at.u.y[0], at.u.z[0]}});
  }
  poses.push_back(to);
  return poses;
}

/// How far a point leaves the chord between two stations.
double bulge(const Path& path, const Envelope& e) {
  const double radius = std::max(e.r_lo_mm, e.r_hi_mm);
  const double reach = std::sqrt(e.hi_mm * e.hi_mm + radius * radius);
  const double turn = path.frame.turn / path.parts;
  return reach * turn * turn / 8 + kEdgeEpsilonMm;
}

}  // namespace

TurningSweep::TurningSweep(const std::variant<ConeSide, ArcSide>& side, const Envelope& envelope,
                           const ToolPose& from, const ToolPose& to, int parts, double search_mm,
                           bool shows_disc)
    : side_(side),
      path_(make_path(envelope, from, to, parts, search_mm, shows_disc)),
      shadow_(envelope, stations(path_, from, to), bulge(path_, envelope)) {}

void TurningSweep::evaluate(ColumnBlock& block) const {
  if (const auto* cone = std::get_if<ConeSide>(&side_)) {
    evaluate_cone(*cone, path_, block);
  } else {
    evaluate_arc(std::get<ArcSide>(side_), path_, block);
  }
}

}  // namespace kerf
