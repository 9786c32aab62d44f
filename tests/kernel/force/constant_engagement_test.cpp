// SPDX-License-Identifier: Apache-2.0
// Properties of the delivered force: constant engagement gives a constant force in any direction,
// at any tick rate and pitch; the force is continuous between kinds of motion; and exactly the cut
// volume is delivered. The bounds are generous; force_bench prints the figures.

#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::constant_engagement_test {
namespace {

const Vec3 kUp{0, 0, 1};
constexpr double kSpecific = 0.5;

struct Setup {
  ToolShape shape = FlatShape{6, 40};
  Rays rays = Rays::kDexel;
  ForceLaw law = ForceLaw::kSpecificEnergy;
  double pitch_mm = 0.1;
};

Sculpture block(const Setup& setup) {
  auto sculpture = *Sculpture::create({.stock = BoxStock{{-8, -8, -12}, {8, 8, 0}},
                                       .rays = setup.rays,
                                       .pitch_mm = setup.pitch_mm,
                                       .tolerance_mm = 0.001,
                                       .force = {setup.law, kSpecific, 0.01, 60}});
  sculpture.apply(DefineTool{1, *make_tool(setup.shape)}).value();
  return sculpture;
}

Vec3 direction_at(double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  return {std::cos(a), std::sin(a), 0};
}

/// Returns the forces of ticks of `step_mm`, after the tool has plunged at `start` and cut 1 mm.
std::vector<Vec3> cut(Sculpture& s, Vec3 start, Vec3 direction, double step_mm,
                      double measured_mm = 3) {
  s.apply(MoveTool{1, {{start.x, start.y, 1}, kUp}, {start, kUp}, 1, false}).value();
  std::vector<Vec3> forces;
  for (int i = 0; i * step_mm < 1 + measured_mm; ++i) {
    const ToolPose from{start + direction * (i * step_mm), kUp};
    const ToolPose to{start + direction * ((i + 1) * step_mm), kUp};
    const MotionResult r = s.apply(MoveTool{1, from, to, step_mm / 30}).value();
    if (i * step_mm >= 1) forces.push_back(r.wrench.force_n);
  }
  return forces;
}

Vec3 mean(const std::vector<Vec3>& forces) {
  Vec3 sum;
  for (const Vec3& f : forces) sum = sum + f;
  return sum * (1 / double(forces.size()));
}

double ripple(const std::vector<Vec3>& forces) {
  const Vec3 m = mean(forces);
  double sum = 0;
  for (const Vec3& f : forces) sum += dot(f - m, f - m);
  return std::sqrt(sum / double(forces.size())) / length(m);
}

Vec3 slot_start(Vec3 direction) { return Vec3{0.0371, 0.0213, -2.03} - direction * 2; }

TEST(ConstantEngagement, GivesConstantForce) {
  for (const ToolShape& shape : {ToolShape{BallShape{6, 40}}, ToolShape{FlatShape{6, 40}}}) {
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      const double bound = rays == Rays::kDexel ? 0.05 : 0.02;
      for (const double degrees : {0.0, 30.0, 45.0, 90.0}) {
        auto s = block({shape, rays});
        const Vec3 direction = direction_at(degrees);
        const auto forces = cut(s, slot_start(direction), direction, 0.03);
        EXPECT_LT(ripple(forces), bound) << to_string(rays) << " " << degrees;
        EXPECT_LT(dot(normalized(mean(forces)), direction), -0.9999);
      }
      auto s = block({shape, rays});
      EXPECT_LT(ripple(cut(s, {0.0371, 0.0213, -3.5}, {0, 0, -1}, 0.03)), bound);
    }
  }
}

TEST(ConstantEngagement, ForceDoesNotDependOnTickLength) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const ForceLaw law : {ForceLaw::kSpecificEnergy, ForceLaw::kDexelRemovalRate}) {
      const Vec3 direction = direction_at(30);
      const auto force = [&](double step_mm) {
        auto s = block({FlatShape{6, 40}, rays, law});
        return mean(cut(s, slot_start(direction), direction, step_mm));
      };
      const Vec3 reference = force(0.03);
      for (const double step_mm : {0.12, 0.0075}) {
        EXPECT_LT(length(force(step_mm) - reference), 0.02 * length(reference)) << step_mm;
      }
    }
  }
}

TEST(ConstantEngagement, ForceDoesNotDependOnPitch) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    const Vec3 direction = direction_at(30);
    const auto force = [&](double pitch_mm) {
      auto s = block({FlatShape{6, 40}, rays, ForceLaw::kSpecificEnergy, pitch_mm});
      return mean(cut(s, slot_start(direction), direction, 0.03));
    };
    EXPECT_LT(length(force(0.1) - force(0.05)), 0.05 * length(force(0.05)));
  }
}

/// One tick of a random path that moves through the block, turns, rests and retracts.
MoveTool wander(const ToolPose& from, std::mt19937_64& random) {
  const auto unit = [&] { return double(random() % 2001) / 1000 - 1; };
  ToolPose to = from;
  const double step = std::pow(10.0, -double(random() % 5));
  if (random() % 4 != 0) to.tip_mm = from.tip_mm + Vec3{unit(), unit(), unit()} * (0.3 * step);
  if (random() % 2 != 0) to.axis = normalized(from.axis + Vec3{unit(), unit(), 0} * (0.02 * step));
  return {1, from, to, 0.001};
}

TEST(Felt, DeliveredVolumeEqualsRemovedVolume) {
  // Without a turn, the volume that a motion delivers is its engaged area times its path. The
  // amount pending at the end is delivered in the air.
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    std::mt19937_64 random(11);
    auto s = block({BallShape{6, 40}, rays});
    ToolPose at{{0.0, 0.0, 0.5}, kUp};
    double felt = 0, removed = 0;
    for (int i = 0; i < 400; ++i) {
      MoveTool move = wander(at, random);
      move.to.axis = kUp;
      if (i == 399) move.to.tip_mm = at.tip_mm + Vec3{0, 0, 20};
      const MotionResult r = s.apply(move).value();
      removed += r.removed_mm3;
      felt += r.cutting.engaged_area_mm2 * length(move.to.tip_mm - move.from.tip_mm);
      at = move.to;
    }
    ASSERT_GT(removed, 1);
    // With three fields the reported volume is weighted differently from the delivered one.
    EXPECT_NEAR(felt / removed, 1, rays == Rays::kDexel ? 1e-9 : 0.03);
    const ToolPose away{at.tip_mm + Vec3{1, 1, 0}, kUp};
    EXPECT_EQ(s.apply(MoveTool{1, at, away, 0.001}).value().wrench, Wrench{});
  }
}

TEST(Felt, ForceNeverPointsAlongTheMotion) {
  // Excludes the few micrometers over which the direction is averaged.
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    auto s = block({FlatShape{6, 40}, rays});
    const Vec3 direction = direction_at(20);
    cut(s, slot_start(direction), direction, 0.03);
    Vec3 at = slot_start(direction) + direction * (0.03 * 134);
    for (int i = 0; i < 30; ++i) {
      const Vec3 back = at - direction * 0.03;
      const MotionResult r = s.apply(MoveTool{1, {at, kUp}, {back, kUp}, 0.001}).value();
      EXPECT_LE(dot(r.wrench.force_n, back - at), 1e-12) << i;
      at = back;
    }
  }
}

TEST(Rest, KeepsTheForceAndItsDirection) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    auto s = block({FlatShape{6, 40}, rays});
    const Vec3 direction = direction_at(20);
    const Vec3 cutting = mean(cut(s, slot_start(direction), direction, 0.03));
    const ToolPose at{slot_start(direction) + direction * (0.03 * 134), kUp};
    for (int i = 0; i < 5; ++i) {
      const MotionResult r = s.apply(MoveTool{1, at, at, 0.001}).value();
      EXPECT_EQ(r.removed_mm3, 0);
      EXPECT_LT(length(r.wrench.force_n - cutting), 0.1 * length(cutting)) << i;
      EXPECT_GT(r.cutting.engaged_area_mm2, 0);
    }
  }
}

TEST(Rest, GivesNoForceUnderTheViscousLaw) {
  auto s = block({FlatShape{6, 40}, Rays::kDexel, ForceLaw::kDexelRemovalRate});
  cut(s, slot_start({1, 0, 0}), {1, 0, 0}, 0.03);
  const ToolPose at{slot_start({1, 0, 0}) + Vec3{1, 0, 0} * (0.03 * 134), kUp};
  EXPECT_EQ(s.apply(MoveTool{1, at, at, 0.001}).value().wrench.force_n, Vec3{});
}

TEST(Rest, TremorDoesNotReverseTheForce) {
  std::mt19937_64 random(5);
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    auto s = block({FlatShape{6, 40}, rays});
    const Vec3 direction = direction_at(20);
    const Vec3 cutting = mean(cut(s, slot_start(direction), direction, 0.03));
    const Vec3 home = slot_start(direction) + direction * (0.03 * 134);
    ToolPose at{home, kUp};
    for (int i = 0; i < 200; ++i) {
      const auto unit = [&] { return double(random() % 2001) / 1000 - 1; };
      const ToolPose to{home + Vec3{unit(), unit(), unit()} * 0.0005, kUp};
      const MotionResult r = s.apply(MoveTool{1, at, to, 0.001}).value();
      EXPECT_GE(dot(r.wrench.force_n, cutting), -0.02 * dot(cutting, cutting)) << i;
      at = to;
    }
  }
}

TEST(ForceDirection, IsContinuousBetweenKindsOfMotion) {
  // A tool in the block is displaced by 0.02 mm at its middle, in steps from pure translation to
  // pure rotation about its tip. The force changes little from one ratio to the next.
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    Wrench last;
    double greatest_n = 0;
    for (int k = 0; k <= 200; ++k) {
      const double turning = k <= 100 ? std::pow(10.0, -6 + 0.06 * k)  // 1e-6 … 1
                                      : 1;
      const double shifting = k <= 100 ? 1 : std::pow(10.0, -0.06 * (k - 100));  // … 1e-6
      const double scale = 0.02 / (turning + shifting);
      auto s = block({FlatShape{6, 12}, rays});
      const ToolPose from{{0.0371, 0.0213, -8}, kUp};
      s.apply(MoveTool{1, {{0.0371, 0.0213, 1}, kUp}, from, 1, false}).value();
      const ToolPose to{from.tip_mm + Vec3{scale * shifting, 0, 0},
                        normalized({scale * turning / 4, 0, 1})};
      const Wrench now = s.apply(MoveTool{1, from, to, 0.001}).value().wrench;
      greatest_n = std::max(greatest_n, length(now.force_n));
      if (k > 0) {
        EXPECT_LT(length(now.force_n - last.force_n), 0.1 * greatest_n) << k;
        const double cosine = dot(normalized(now.force_n), normalized(last.force_n));
        EXPECT_GT(cosine, std::cos(8 * std::numbers::pi / 180)) << k;
      }
      last = now;
    }
  }
}

}  // namespace
}  // namespace kerf::constant_engagement_test
