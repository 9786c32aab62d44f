// SPDX-License-Identifier: Apache-2.0
// The force of a tool that changes direction within the stock, with and without a stop: force
// pending from the old direction must not add up with that of the new one.
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::new_direction_test {
namespace {

constexpr double kStepMm = 0.03;
const Vec3 kUp{0, 0, 1};

/// A flat end of 6 mm in a block.
class Mill {
 public:
  explicit Mill(Rays rays, Vec3 start) : block_(make(rays)), at_{start, kUp} {}

  /// Returns the forces of the ticks of a straight motion.
  std::vector<double> go(Vec3 direction, double mm) {
    std::vector<double> forces;
    for (double s = 0; s < mm; s += kStepMm) forces.push_back(tick(direction * kStepMm));
    return forces;
  }
  void rest() {
    for (int i = 0; i < 20; ++i) tick({});
  }

 private:
  static Sculpture make(Rays rays) {
    Sculpture block = Sculpture::create({.stock = BoxStock{{-15, -15, -10}, {15, 15, 0}},
                                         .rays = rays,
                                         .pitch_mm = 0.25,
                                         .force = {.law = ForceLaw::kSpecificEnergy,
                                                   .specific_force_n_per_mm2 = 0.5}})
                          .value();
    block.apply(DefineTool{1, make_tool(FlatShape{6, 40}).value()}).value();
    return block;
  }
  double tick(Vec3 moved) {
    const ToolPose to{at_.tip_mm + moved, kUp};
    const MotionResult result = block_.apply(MoveTool{1, at_, to, 0.001}).value();
    at_ = to;
    return length(result.wrench.force_n);
  }

  Sculpture block_;
  ToolPose at_;
};

TEST(NewDirection, HasAtMostTheForceOfItsOwnEngagement) {
  // In the plane the engagement stays that of a slot, 6 N; a plunge engages the floor, 14.1 N.
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const bool stops : {false, true}) {
      for (const double degrees : {30.0, 60.0, 90.0, 120.0, 150.0}) {
        Mill mill(rays, {-12, 0, -2});
        mill.go({1, 0, 0}, 8);
        if (stops) mill.rest();
        const double angle = degrees * std::numbers::pi / 180;
        const auto forces = mill.go({std::cos(angle), std::sin(angle), 0}, 5);
        // The ripple of one field is up to 12 %.
        EXPECT_LT(std::ranges::max(forces), 1.13 * 6) << degrees;
      }
      Mill mill(rays, {-12, 0, -2});
      mill.go({1, 0, 0}, 8);
      if (stops) mill.rest();
      const auto plunge = mill.go({0, 0, -1}, 1);
      EXPECT_NEAR(plunge.back(), 0.5 * std::numbers::pi * 9, 0.02 * plunge.back());
      EXPECT_LT(std::ranges::max(plunge), 1.02 * plunge.back());
    }
  }
}

/// The greatest force of a random walk within the block.
double greatest_of_walk(std::uint32_t seed, Rays rays, bool stops) {
  std::mt19937 random(seed);
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  Mill mill(rays, {0, 0, -3});
  double z = -3, greatest = 0;
  for (int part = 0; part < 40; ++part) {
    Vec3 direction = normalized({unit() - 0.5, unit() - 0.5, 0.5 * unit() - 0.25});
    if ((z > -1 && direction.z > 0) || (z < -6 && direction.z < 0)) direction.z = -direction.z;
    const double mm = 0.1 + 1.4 * unit();
    greatest = std::max(greatest, std::ranges::max(mill.go(direction, mm)));
    z += direction.z * mm;
    if (stops) mill.rest();
  }
  return greatest;
}

TEST(NewDirection, StopsDoNotRaiseTheForceOfARandomWalk) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const double one = greatest_of_walk(seed, Rays::kDexel, true);
    const double three = greatest_of_walk(seed, Rays::kTriDexel, true);
    EXPECT_NEAR(one, greatest_of_walk(seed, Rays::kDexel, false), 0.01 * one) << seed;
    EXPECT_NEAR(three, greatest_of_walk(seed, Rays::kTriDexel, false), 0.01 * three) << seed;
    // Includes the ripple, and force delivered late while the new direction cuts.
    EXPECT_LT(one, 1.35 * three) << seed;
    EXPECT_GT(three, 5) << seed;
  }
}

}  // namespace
}  // namespace kerf::new_direction_test
