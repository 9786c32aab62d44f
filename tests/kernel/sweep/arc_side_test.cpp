// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/piece_side.h"
#include "tests/support/test.h"

namespace kerf::arc_side_test {
namespace {

const ArcPiece kSidesOfArcs[] = {
    {3, 2, 2, 0, 2},                                         // the corner of a bull-nose
    {3, 0.05, 0.05, 0, 0.05}, {-24.9954541, 12, 30, 0, 24},  // a barrel
    {1.5, 7.7, 4, 4, 11},     {0, 5, 5, 0, 3},
    {-2.5e-4, 4, 4, 0, 7.7}};

/// Distance of the point of a ray at the height t from an arc's side about the origin.
struct AlongRay {
  ArcPiece arc;
  Vec3 u;
  double x, y;

  double operator()(double t) const {
    const Vec3 p{x, y, t};
    const double l = dot(p, u);
    return side_distance(arc, length(p - u * l), l + arc.center_z_mm).mm;
  }
  /// Returns the height at which it is least.
  double least_at() const {
    constexpr double kGolden = 0.6180339887498949;
    double a = -60, b = 60;
    for (int i = 0; i < 90; ++i) {
      const double s = b - kGolden * (b - a), t = a + kGolden * (b - a);
      ((*this)(s) < (*this)(t) ? b : a) = (*this)(s) < (*this)(t) ? t : s;
    }
    return (a + b) / 2;
  }
};

template <End end>
SideSpan meet(const ArcSide& side, const AlongRay& ray, const DiscSpan& discs) {
  const Vec3Lanes u{Lanes(ray.u.x), Lanes(ray.u.y), Lanes(ray.u.z)};
  return side.meet<end>(Lanes(ray.x), Lanes(ray.y), u, Lanes(ray.x * ray.u.x + ray.y * ray.u.y),
                        discs);
}

/// The searched end is on the side, the other end on the side or at the disc before it. For a ray
/// that misses the side, the closest height is found.
TEST(ArcSide, FindsTheRootOrTheClosestHeight) {
  std::mt19937_64 random(5);
  const test::Uniform in(random);
  int hits = 0, misses = 0;
  for (int k = 0; k < 3000; ++k) {
    const ArcPiece& arc = kSidesOfArcs[std::size_t(k) % std::size(kSidesOfArcs)];
    const ArcSide side(arc);
    const double lean = k % 4 == 0 ? 0 : k % 4 == 1 ? 3 : 0.3;
    const Vec3 u = k % 40 == 7 ? Vec3{1, 0, 0}
                               : normalized({in(-lean, lean), in(-lean, lean), k % 3 ? 1.0 : -1.0});
    const AlongRay ray{arc, u, in(-6, 6), in(-6, 6)};
    const double best = ray.least_at(), gap = ray(best);
    const double upright = std::max(std::abs(u.z), kAxisAlongRayMin);
    const DiscSpan discs{Lanes(best - in(0, 3)), Lanes(best + in(0, 3)),
                         Lanes(u.z < 0 ? -1 / upright : 1 / upright)};
    const SideSpan lower = meet<End::kLower>(side, ray, discs);
    const SideSpan upper = meet<End::kUpper>(side, ray, discs);
    const bool exists = bits(lower.exists) != 0;
    ASSERT_EQ(exists, bits(upper.exists) != 0);
    if (!exists) {
      ++misses;
      EXPECT_GT(gap, -1e-10) << k;
      EXPECT_NEAR(ray(lower.closest[0]), gap, 1e-9) << k;
      EXPECT_NEAR(ray(upper.closest[0]), gap, 1e-9) << k;
      continue;
    }
    ++hits;
    EXPECT_LT(gap, 1e-10) << k;
    EXPECT_NEAR(ray(lower.in[0]), 0, 1e-10) << k;
    EXPECT_NEAR(ray(upper.out[0]), 0, 1e-10) << k;
    if (gap > -1e-9) continue;
    EXPECT_LT(lower.in[0], best);
    EXPECT_GT(upper.out[0], best);
    EXPECT_NEAR(lower.out[0], std::min(upper.out[0], discs.out[0]), 1e-6) << k;
    EXPECT_NEAR(upper.in[0], std::max(lower.in[0], discs.in[0]), 1e-6) << k;
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(misses, 500);
}

TEST(ArcSide, OnlyUpperEndsAboveTheTopAreLeftInexact) {
  std::mt19937_64 random(11);
  const test::Uniform in(random);
  int exact = 0, inexact = 0;
  for (int k = 0; k < 3000; ++k) {
    const ArcPiece& arc = kSidesOfArcs[std::size_t(k) % std::size(kSidesOfArcs)];
    const ArcSide side(arc);
    const AlongRay ray{arc, normalized({in(-1, 1), in(-1, 1), 1}), in(-6, 6), in(-6, 6)};
    const Lanes along = ray.x * ray.u.x + ray.y * ray.u.y, inverse = Lanes(1 / ray.u.z);
    const Lanes low = (side.low - along) * inverse, high = (side.high - along) * inverse;
    const double top = in(-4, 8);
    const SideSpan whole = meet<End::kLower>(side, ray, {low, high, inverse});
    const SideSpan below = meet<End::kLower>(side, ray, {low, high, inverse, Lanes(top)});
    ASSERT_EQ(bits(below.exists), bits(whole.exists));
    if (bits(whole.exists) == 0) continue;
    EXPECT_EQ(below.in[0], whole.in[0]) << k;
    if (below.out[0] == whole.out[0]) {
      ++exact;
    } else {
      ++inexact;
      EXPECT_GE(below.out[0], top) << k;
      EXPECT_GE(whole.out[0], top) << k;
    }
  }
  EXPECT_GT(exact, 500);
  EXPECT_GT(inexact, 100);
}

/// Rays are packed into lanes in any order, and which rays are packed depends on the stock.
TEST(ArcSide, LanesAreIndependent) {
  std::mt19937_64 random(7);
  const test::Uniform in(random);
  int hits = 0;
  for (int k = 0; k < 3000; ++k) {
    const ArcSide side(kSidesOfArcs[std::size_t(k) % std::size(kSidesOfArcs)]);
    const Vec3 u = normalized(Vec3{in(-0.5, 0.5), in(-0.5, 0.5), 1});
    Lanes x, y;
    for (int lane = 0; lane < kLanes; ++lane) {
      x.set(lane, in(-6, 6));
      y.set(lane, in(-6, 6));
    }
    const auto met = [&](Lanes at_x, Lanes at_y) {
      const Lanes along = at_x * u.x + at_y * u.y, inverse = Lanes(1 / u.z);
      return side.meet<End::kLower>(
          at_x, at_y, {Lanes(u.x), Lanes(u.y), Lanes(u.z)}, along,
          {(side.low - along) * inverse, (side.high - along) * inverse, inverse});
    };
    const SideSpan together = met(x, y), alone = met(Lanes(x[0]), Lanes(y[0]));
    const bool exists = (bits(alone.exists) & 1U) != 0;
    ASSERT_EQ((bits(together.exists) & 1U) != 0, exists) << k;
    if (!exists) continue;
    ++hits;
    EXPECT_EQ(together.in[0], alone.in[0]) << k;
    EXPECT_EQ(together.out[0], alone.out[0]) << k;
    EXPECT_EQ(together.depth[0], alone.depth[0]) << k;
  }
  EXPECT_GT(hits, 500);
}

}  // namespace
}  // namespace kerf::arc_side_test
