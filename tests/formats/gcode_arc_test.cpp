// SPDX-License-Identifier: Apache-2.0
#include "server/formats/control/arc.h"
#include "server/formats/control/fault.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::gcode_arc_test {
namespace {

using test::error_of;
using test::gcode;
using test::scene_for;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

void expect_near(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

// The axes of a plane: first, second and normal, right-handed.
struct Plane {
  ArcPlane plane;
  Vec3 first, second, normal;
};
const Plane kPlanes[] = {{ArcPlane::kXy, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                         {ArcPlane::kZx, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                         {ArcPlane::kYz, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}}};

TEST(GcodeArc, PointsAreOnTheCircleInEveryPlane) {
  for (const Plane& p : kPlanes) {
    for (const bool clockwise : {false, true}) {
      const double sign = clockwise ? -1 : 1;
      const Vec3 center = p.first * 3 + p.second * 4;
      const auto on_circle = [&](double degrees) {
        const double a = sign * degrees * kPi / 180;
        return center + p.first * (10 * std::cos(a)) + p.second * (10 * std::sin(a));
      };
      const Arc arc =
          make_arc(on_circle(0), on_circle(120), p.plane, {.ijk = p.first * -10}, clockwise, 1);
      for (int i = 0; i <= 12; ++i) expect_near(arc.at(i / 12.0), on_circle(10 * i), 1e-12);
      EXPECT_NEAR(arc.length_mm(), 10 * 2 * kPi / 3, 1e-12);
    }
  }
}

TEST(GcodeArc, FullCircleIsNotDropped) {
  const Arc arc = make_arc({1, 0, 0}, {1, 0, 0}, ArcPlane::kXy, {.ijk = {-1, 0, 0}}, true, 1);
  EXPECT_NEAR(arc.sweep_rad, -2 * kPi, 1e-15);
  expect_near(arc.at(0.25), {0, -1, 0}, 1e-15);
  EXPECT_EQ(arc.at(1), (Vec3{1, 0, 0}));
}

TEST(GcodeArc, TurnsMakeAHelix) {
  const Arc arc = make_arc({1, 0, 0}, {0, 1, 6}, ArcPlane::kXy, {.ijk = {-1, 0, 0}}, false, 3);
  EXPECT_NEAR(arc.sweep_rad, 4.5 * kPi, 1e-14);
  expect_near(arc.at(4.0 / 9), {1, 0, 6 * 4.0 / 9}, 1e-12);
  EXPECT_NEAR(arc.length_mm(), std::hypot(4.5 * kPi, 6), 1e-12);
}

TEST(GcodeArc, PositiveRadiusGivesShortArcNegativeLongArc) {
  for (const Plane& p : kPlanes) {
    for (const bool clockwise : {false, true}) {
      const Vec3 start = p.first * 5;
      const Vec3 end = p.second * 5;
      const double quarter = clockwise ? -1.5 * kPi : kPi / 2;
      const Arc about_zero =
          make_arc(start, end, p.plane, {.ijk = {}, .radius = clockwise ? -5 : 5}, clockwise, 1);
      EXPECT_NEAR(about_zero.sweep_rad, quarter, 1e-12);
      expect_near(about_zero.at(0.5), (p.first + p.second) * ((clockwise ? -5 : 5) / std::sqrt(2)),
                  1e-12);
      const Arc other =
          make_arc(start, end, p.plane, {.ijk = {}, .radius = clockwise ? 5 : -5}, clockwise, 1);
      EXPECT_NEAR(std::abs(other.sweep_rad), 2 * kPi - std::abs(quarter), 1e-12);
    }
  }
}

TEST(GcodeArc, RadiusRoundedBelowHalfTheChordIsAHalfCircle) {
  const Arc arc =
      make_arc({0, 0, 0}, {10.001, 0, 0}, ArcPlane::kXy, {.ijk = {}, .radius = 5}, false, 1);
  EXPECT_NEAR(arc.sweep_rad, kPi, 1e-9);
}

TEST(GcodeArc, ChordsStayWithinTheTolerance) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> angle(-kPi, kPi);
    const double radius = std::exp(std::uniform_real_distribution<double>(-3, 5)(random));
    const double tolerance = std::exp(std::uniform_real_distribution<double>(-8, -1)(random));
    const double a = angle(random);
    const double b = angle(random);
    const Arc arc = make_arc({radius * std::cos(a), radius * std::sin(a), 0},
                             {radius * std::cos(b), radius * std::sin(b), 1}, ArcPlane::kXy,
                             {.ijk = {}, .absolute = true}, seed % 2 == 0, 1);
    const int chords = arc.chords(tolerance);
    for (int i = 0; i < chords; ++i) {
      const Vec3 middle =
          (arc.at(static_cast<double>(i) / chords) + arc.at((i + 1.0) / chords)) * 0.5;
      ASSERT_GE(std::hypot(middle.x, middle.y), radius - tolerance * (1 + 1e-6) - 1e-9)
          << "seed " << seed;
    }
  }
}

TEST(GcodeArc, ImpossibleArcsAreRejected) {
  const auto fault = [](Vec3 end, const ArcCenter& center) {
    EXPECT_THROW(make_arc({0, 0, 0}, end, ArcPlane::kXy, center, false, 1), ProgramFault);
  };
  fault({10, 0, 0}, {.ijk = {4, 0, 0}});
  fault({10, 0, 0}, {.ijk = {0, 0, 0}});
  fault({10, 0, 0}, {.ijk = {}, .radius = 4.9});
  fault({0, 0, 5}, {.ijk = {}, .radius = 4.9});
  // Radii that differ by up to 0.004 mm or 0.1 % count as rounding of the program.
  make_arc({0, 0, 0}, {10.004, 0, 0}, ArcPlane::kXy, {.ijk = {5, 0, 0}}, false, 1);
  make_arc({0, 0, 0}, {1000.4, 0, 0}, ArcPlane::kXy, {.ijk = {500, 0, 0}}, false, 1);
}

TEST(GcodeArc, EquivalentWordsGiveTheSameArc) {
  const Scene scene = scene_for("xyz", 0.001);
  const std::string start = "G21 G90 T1 M6 F600\nG0 X10 Y0 Z0\n";
  // Relative center, absolute center, radius, increments and inches give the same quarter circle.
  for (const char* block :
       {"G3 X0 Y10 I-10", "G3 X0 Y10 I-10 J0", "G90.1 G3 X0 Y10 I0 J0", "G3 X0 Y10 R10",
        "G91 G3 X-10 Y10 I-10", "G20\nG3 X0 Y[10/25.4] I[-10/25.4] F[600/25.4]"}) {
    const Program program = gcode(scene, start + block + "\nM2\n");
    ASSERT_GT(program.motions.size(), 20u) << block;
    double duration = 0;
    for (const ProgramMotion& motion : program.motions) {
      EXPECT_NEAR(std::hypot(motion.to.tip_mm.x, motion.to.tip_mm.y), 10, 2e-6) << block;
      duration += motion.duration_s;
    }
    EXPECT_NEAR(duration, 10 * kPi / 2 / 10, 1e-6) << block;
    EXPECT_EQ(program.motions.back().to.tip_mm, (Vec3{0, 10, 0})) << block;
  }
  const Program full = gcode(scene, start + "G2 I-10 P2\nM2\n");
  EXPECT_EQ(full.motions.back().to, full.motions.front().from);
  const Program zx = gcode(scene, start + "G18 G2 X0 Z10 R10\nM2\n");
  for (const ProgramMotion& motion : zx.motions) {
    EXPECT_EQ(motion.to.tip_mm.y, 0);
    EXPECT_NEAR(std::hypot(motion.to.tip_mm.x, motion.to.tip_mm.z), 10, 2e-6);
  }
}

TEST(GcodeArc, ErrorsNameTheInvalidWord) {
  const Scene scene = scene_for("xyz");
  const auto word_of = [&](const std::string& block) {
    const ProgramError error =
        error_of(scene, "p.ngc", "T1 M6 F600\nG0 X10 Y0 Z0\n" + block + "\nM2\n");
    EXPECT_EQ(error.line, 3u);
    return error.word;
  };
  EXPECT_EQ(word_of("G2 X0 Y10 K5 I-10"), "K5");
  EXPECT_EQ(word_of("G18 G2 X0 Z10 J5"), "J5");
  EXPECT_EQ(word_of("G2 X0 Y10 R5 I1"), "R5");
  EXPECT_EQ(word_of("G2 X0 Y10 R0"), "R0");
  EXPECT_EQ(word_of("G2 X0 Y10"), "G2 X0 Y10");
  EXPECT_EQ(word_of("G2 X0 Y10 I-10 P0"), "P0");
  EXPECT_EQ(word_of("G2 X0 Y10 I-10 P1.5"), "P1.5");
  EXPECT_EQ(word_of("G90.1 G2 X0 Y10 I0"), "G90.1");
  EXPECT_EQ(word_of("G1 X5 I1"), "I1");
  EXPECT_EQ(word_of("G1 X5 R1"), "R1");
  EXPECT_THAT(word_of("G2 X0 Y11 I-10"), HasSubstr("G2"));
}

}  // namespace
}  // namespace kerf::gcode_arc_test
