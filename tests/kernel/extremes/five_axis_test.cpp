// The promise of the tight model: whatever the motion, no end point errs by more than the
// tolerance.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/kernel/extremes/carving.h"

namespace kerf::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double in(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }
  Vec3 direction() { return normalized({in(-1, 1), in(-1, 1), in(-1, 1)}); }

 private:
  std::mt19937_64 engine_;
};

struct Motion {
  ToolPose from, to;
};

ToolPose start(Random& random, double lean_max) {
  return leaning({random.in(-2, 2), random.in(-2, 2), random.in(-7, -1)}, random.in(0, lean_max),
                 random.in(0, 6.2));
}

void judge(const NamedTool& t, double tolerance, const Motion& m, const std::string& what,
           int columns) {
  Carving carving(block(44, 20, 1.1, tolerance), t.tool);
  carving.move(m.from, m.to);
  carving.expect_within_tolerance(t.name + ", tolerance " + std::to_string(tolerance) + ", " + what,
                                  columns);
}

class FiveAxis : public testing::TestWithParam<double> {};

TEST_P(FiveAxis, StandardTurns) {
  for (const NamedTool& t : every_tool()) {
    for (unsigned seed = 0; seed < 8u * unsigned(effort()); ++seed) {
      Random random(seed);
      const ToolPose a = start(random, 0.4);
      const Vec3 u = turned(a.axis, random.direction(), 2.5 * kDegree);
      judge(t, GetParam(), {a, {a.tip_mm + random.direction(), u}}, "2.5 degrees", 25);
    }
  }
}

TEST_P(FiveAxis, LargeTurnsWithAnyPivot) {
  for (const NamedTool& t : every_tool()) {
    for (unsigned seed = 0; seed < 8u * unsigned(effort()); ++seed) {
      Random random(1000000 + seed);
      const ToolPose a = start(random, 1.2);
      const unsigned which = seed % 8;
      const double turn = which == 0 ? 169.99 * kDegree : random.in(0.2, 2.9);
      const Vec3 u = turned(a.axis, random.direction(), turn);
      // The tip, the ball's centre, points of the axis within the tool, above and below it; or
      // none.
      const double pivots[] = {0, 5, 2.5, 17, 80, -25};
      const bool any = which >= 6;
      const Vec3 tip = any ? a.tip_mm + random.direction() * random.in(0, 15)
                           : a.tip_mm + (a.axis - u) * pivots[which];
      judge(t, GetParam(), {a, {tip, u}}, "seed " + std::to_string(seed), 12);
    }
  }
}

TEST_P(FiveAxis, LongBlocksOfAProgram) {
  for (const NamedTool& t : every_tool()) {
    for (unsigned seed = 0; seed < 4u * unsigned(effort()); ++seed) {
      Random random(2000000 + seed);
      ToolPose a = start(random, 0.5);
      const Vec3 way = normalized({random.in(-1, 1), random.in(-1, 1), 0}) * random.in(60, 400);
      const Vec3 u = turned(a.axis, random.direction(), random.in(0.05, 1));
      a.tip_mm = a.tip_mm - way * 0.5;
      judge(t, GetParam(), {a, {a.tip_mm + way, u}}, "long " + std::to_string(seed), 15);
    }
  }
}

TEST_P(FiveAxis, TicksOfAHand) {
  for (const NamedTool& t : every_tool()) {
    for (unsigned seed = 0; seed < 6u * unsigned(effort()); ++seed) {
      Random random(3000000 + seed);
      const ToolPose a = start(random, 1);
      const Vec3 u = turned(a.axis, random.direction(), random.in(0, 0.02) * kDegree);
      judge(t, GetParam(), {a, {a.tip_mm + random.direction() * random.in(0, 2e-3), u}}, "tick",
            15);
    }
  }
}

TEST_P(FiveAxis, PlungesThatTurn) {
  // Mostly along the axis: the side of a cone is lit all around for part of the way only.
  for (const NamedTool& t : every_tool()) {
    for (unsigned seed = 0; seed < 6 * unsigned(effort()); ++seed) {
      Random random(4000000 + seed);
      const ToolPose a = start(random, 0.6);
      const Vec3 u = turned(a.axis, random.direction(), random.in(0, seed % 2 == 0 ? 0.02 : 0.4));
      const Vec3 way = a.axis * random.in(-8, 8) + random.direction() * random.in(0, 0.5);
      judge(t, GetParam(), {a, {a.tip_mm + way, u}}, "plunge " + std::to_string(seed), 15);
    }
  }
}

TEST_P(FiveAxis, LyingAndUpsideDownTools) {
  for (const NamedTool& t : every_tool()) {
    for (unsigned seed = 0; seed < 6 * unsigned(effort()); ++seed) {
      Random random(5000000 + seed);
      const double lean = (seed % 2 == 0 ? random.in(80, 100) : random.in(100, 180)) * kDegree;
      const ToolPose a = leaning({random.in(-9, 9), random.in(-9, 9), random.in(-14, -4)}, lean,
                                 random.in(0, 6.2));
      const Vec3 u = turned(a.axis, random.direction(), random.in(0, 0.3));
      judge(t, GetParam(), {a, {a.tip_mm + random.direction() * random.in(0, 4), u}},
            "lying " + std::to_string(seed), 15);
    }
  }
}

TEST_P(FiveAxis, EveryFieldOfThree) {
  for (const NamedTool& t : every_tool()) {
    for (unsigned seed = 0; seed < 3 * unsigned(effort()); ++seed) {
      Random random(6000000 + seed);
      const ToolPose a = start(random, 1.2);
      const Vec3 u = turned(a.axis, random.direction(), random.in(0, 0.5));
      SculptureSettings settings = block(44, 20, 1.3, GetParam());
      settings.rays = Rays::kTriDexel;
      Carving carving(settings, t.tool);
      carving.move(a, {a.tip_mm + random.direction() * random.in(0, 6), u});
      carving.expect_within_tolerance(t.name + " seed " + std::to_string(seed), 12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Tolerance, FiveAxis, testing::Values(0.1, 0.01, 0.001, 0.0001),
                         [](const auto& p) {
                           return p.param == 0.1     ? "tenth"
                                  : p.param == 0.01  ? "hundredth"
                                  : p.param == 0.001 ? "micrometre"
                                                     : "tenth_of_a_micrometre";
                         });

}  // namespace
}  // namespace kerf::test
