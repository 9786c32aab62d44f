// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/ball_sweep.h"

#include <algorithm>
#include <span>

namespace kerf {
namespace {

/// Lower bounds of the heights that a capsule removes within each disc, or +inf where it removes
/// nothing. At horizontal distance ρ from the path the ball reaches √(r² − ρ²) below it, and no
/// point of the path is below its lower end. If no point of the surface advances (the ball moves
/// away from the whole disc), the ball at the start has already removed everything.
struct CapsuleBound {
  Lanes z;
  LaneMask reached, advances;
};
KERF_INLINE CapsuleBound bound_capsule(const RayCapsule& c, const Discs& discs, double radius,
                                       bool start_is_cut) {
  const Lanes px = discs.x_mm - c.from.x, py = discs.y_mm - c.from.y;
  const Lanes along = px * c.along_x + py * c.along_y;
  const Lanes s = lesser(greater(along * c.inverse_h, Lanes(0)), Lanes(1));
  const Lanes ex = px - s * c.d.x, ey = py - s * c.d.y;
  const Lanes off = greater(square_root(ex * ex + ey * ey) - discs.reach_mm, Lanes(0));
  const Lanes w2 = c.radius2 - off * off;
  const double lowest = c.from.z < c.to.z ? c.from.z : c.to.z;
  const double away = radius * ((c.lean < 0 ? c.lean : -c.lean) - kRecedingMm * c.inverse_length);
  const LaneMask reached = w2 >= 0.0;
  const LaneMask advances = start_is_cut ? along + discs.reach_mm > away : w2 == w2;
  return {select(reached & advances, lowest - square_root(w2),
                 Lanes(std::numeric_limits<double>::infinity())),
          reached, advances};
}

KERF_INLINE unsigned bound_chain_in_lanes(std::span<const RayCapsule> capsules, const Discs& discs,
                                          double radius, bool start_is_cut, Lanes& z) {
  LaneMask reached = ~every_lane(), swept = reached;
  for (const RayCapsule& c : capsules) {
    const CapsuleBound bound = bound_capsule(c, discs, radius, start_is_cut);
    z = lesser(bound.z, z);
    reached = reached | bound.reached;
    swept = swept | (bound.reached & bound.advances);
    start_is_cut = true;  // the previous capsule ended there
  }
  return bits(reached & ~swept);
}
KERF_FOR_EACH_TARGET(unsigned, bound_chain,
                     (std::span<const RayCapsule> capsules, const Discs& discs, double radius,
                      bool start_is_cut, Lanes& z),
                     (capsules, discs, radius, start_is_cut, z))

KERF_INLINE void evaluate_chain_in_lanes(std::span<const RayCapsule> capsules, ColumnBlock& block) {
  for (const RayCapsule& c : capsules) {
    // A ball whose center stays above the stock has no upper end in it.
    const bool above = c.from.z >= block.top_mm && c.to.z >= block.top_mm;
    for (int row = 0; row < kBlockSide; ++row) {
      if ((block.rows >> row & 1) == 0) continue;
      const Lanes y = Lanes(block.y_mm[row]);
      LaneSpan span;
      if (above) {
        const LaneEnd lower = c.lower_end(block.x_mm, y);
        span.lo = select(lower.hit, lower.z, span.lo);
        span.hi = select(lower.hit, Lanes(block.top_mm + block.join_mm), span.hi);
      } else {
        c.extend(span, block.x_mm, y);
      }
      block.add(row, span.lo, span.hi);
    }
  }
}
KERF_FOR_EACH_TARGET(void, evaluate_chain,
                     (std::span<const RayCapsule> capsules, ColumnBlock& block), (capsules, block))

}  // namespace

BallSweep::BallSweep(const std::vector<Vec3>& centers_mm, double radius_mm, bool start_is_cut)
    : radius_(radius_mm), start_is_cut_(start_is_cut) {
  for (std::size_t i = 1; i < centers_mm.size(); ++i) {
    capsules_.emplace_back(centers_mm[i - 1], centers_mm[i], radius_mm);
  }
}

SweepBounds BallSweep::bounds() const {
  const Vec3 r{radius_, radius_, radius_};
  SweepBounds b{capsules_.front().from - r, capsules_.front().from + r};
  for (const RayCapsule& c : capsules_) {
    b.min_mm = {std::min(b.min_mm.x, c.to.x - radius_), std::min(b.min_mm.y, c.to.y - radius_),
                std::min(b.min_mm.z, c.to.z - radius_)};
    b.max_mm = {std::max(b.max_mm.x, c.to.x + radius_), std::max(b.max_mm.y, c.to.y + radius_),
                std::max(b.max_mm.z, c.to.z + radius_)};
  }
  return b;
}

LeftOut BallSweep::lower_bound(const Discs& discs, Lanes& z_mm) const {
  const unsigned behind = bound_chain(capsules_, discs, radius_, start_is_cut_, z_mm);
  return {.behind = behind, .shown_behind = behind};
}

void BallSweep::evaluate(ColumnBlock& block) const { evaluate_chain(capsules_, block); }

bool BallSweep::stays_above(double z_mm) const {
  return std::ranges::all_of(
      capsules_, [&](const RayCapsule& c) { return c.from.z >= z_mm && c.to.z >= z_mm; });
}

}  // namespace kerf
