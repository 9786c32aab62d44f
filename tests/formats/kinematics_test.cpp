// SPDX-License-Identifier: Apache-2.0
#include "kernel/math/rotation.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/units.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::kinematics_test {
namespace {

using test::error_of;
using test::gcode;
using test::scene_for;
using testing::HasSubstr;

void expect_near(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

Machine machine_of(MachineKinematics kinematics) { return Machine{.kinematics = kinematics}; }

TEST(MachineKinematics, PositiveTableAngleTiltsTheToolTheOppositeDirection) {
  // A = 90 turns the workpiece's +Y towards the spindle, so the tool axis is +Y.
  expect_near(table_axis(machine_of(MachineKinematics::kXyzacTrt), {.a = 90}), {0, 1, 0}, 0);
  expect_near(table_axis(machine_of(MachineKinematics::kXyzacTrt), {.a = 90, .c = 90}), {1, 0, 0},
              0);
  expect_near(table_axis(machine_of(MachineKinematics::kXyzbcTrt), {.b = 90}), {-1, 0, 0}, 0);
  expect_near(table_axis(machine_of(MachineKinematics::kXyzbcTrt), {.b = 90, .c = 90}), {0, 1, 0},
              0);
  for (const auto kind : {MachineKinematics::kXyzacTrt, MachineKinematics::kXyzbcTrt})
    expect_near(table_axis(machine_of(kind), {.c = 33}), {0, 0, 1}, 0);
}

TEST(MachineKinematics, APositiveAngleMayTurnTheTool) {
  for (const auto kind : {MachineKinematics::kXyzacTrt, MachineKinematics::kXyzbcTrt}) {
    Machine tool = machine_of(kind);
    tool.rotary_direction = RotaryDirection::kTool;
    const RotaryAngles angles{.a = 30, .b = 30, .c = 40}, others{.a = -30, .b = -30, .c = -40};
    EXPECT_EQ(table_axis(tool, angles), table_axis(machine_of(kind), others));
    EXPECT_EQ(tip_from_programmed(tool, false, {1, 2, 3}, angles),
              tip_from_programmed(machine_of(kind), false, {1, 2, 3}, others));
    const Vec3 axis = table_axis(tool, angles);
    const RotaryAngles found = angles_from_axis(tool, axis, angles);
    expect_near(table_axis(tool, found), axis, 1e-14);
    EXPECT_NEAR(found.c, 40, 1e-9);
  }
  // In ISO 841, B30 tilts the tool towards +X.
  const std::string text = "G43.4 H1\nG0 X0 Y0 Z5 B30 C0\nG1 X1 F99\nM30\n";
  Scene scene = scene_for("xyzbc-trt");
  GcodeEnvironment environment{.dialect = Dialect::kFanuc};
  for (const auto direction : {RotaryDirection::kTable, RotaryDirection::kTool}) {
    scene.machine.rotary_direction = direction;
    const auto program =
        test::value_of(parse_program("p.nc", "G21 G90\nT1 M6\n" + text, scene, environment));
    EXPECT_NEAR(program.motions.back().to.axis.x, direction == RotaryDirection::kTool ? 0.5 : -0.5,
                1e-9);
  }
}

TEST(MachineKinematics, AnglesReproduceTheAxisAndStayNearThePreviousOnes) {
  for (const auto kind : {MachineKinematics::kXyzacTrt, MachineKinematics::kXyzbcTrt}) {
    RotaryAngles angles;
    Vec3 axis{0, 0, 1};
    for (std::uint64_t seed = 0; seed < 3000; ++seed) {
      std::mt19937_64 random(seed);
      std::normal_distribution<double> normal(0, 0.03);
      axis = normalized(axis + Vec3{normal(random), normal(random), normal(random)});
      const RotaryAngles next = angles_from_axis(machine_of(kind), axis, angles);
      ASSERT_LT(length(table_axis(machine_of(kind), next) - axis), 1e-14) << "seed " << seed;
      const double tilt =
          kind == MachineKinematics::kXyzacTrt ? next.a - angles.a : next.b - angles.b;
      ASSERT_LE(std::abs(tilt) + std::abs(next.c - angles.c), 360) << "seed " << seed;
      // Away from the vertical a small turn of the axis changes the angles little.
      if (std::abs(axis.z) < 0.9) {
        ASSERT_LE(std::abs(next.c - angles.c), 60) << "seed " << seed;
      }
      angles = next;
    }
  }
}

TEST(MachineKinematics, ProgrammedFromTipIsInverse) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> any(-200, 200);
    const Vec3 p{any(random), any(random), any(random)};
    const RotaryAngles angles{any(random), any(random), any(random)};
    for (const auto kind : {MachineKinematics::kXyzacTrt, MachineKinematics::kXyzbcTrt}) {
      const Vec3 tip = tip_from_programmed(machine_of(kind), false, p, angles);
      EXPECT_LT(length(programmed_from_tip(machine_of(kind), false, tip, angles) - p), 1e-12);
      // The spindle is vertical in the machine: 1 mm up is 1 mm along the tool axis.
      const Vec3 up = tip_from_programmed(machine_of(kind), false, p + Vec3{0, 0, 1}, angles) - tip;
      EXPECT_LT(length(up - table_axis(machine_of(kind), angles)), 1e-12);
      EXPECT_EQ(tip_from_programmed(machine_of(kind), true, p, angles), p);
    }
  }
}

TEST(MachineKinematics, TipStaysOnItsLineWithToolCenterPoint) {
  const Program program = gcode(scene_for("xyzac-trt", 0.001),
                                "T1 M6\nM428\nG0 X0 Y0 Z0 A0 C0\nG1 X10 A30 C90 F600\nM2\n");
  ASSERT_GT(program.motions.size(), 4u);
  double duration = 0;
  for (const ProgramMotion& motion : program.motions) {
    duration += motion.duration_s;
    EXPECT_EQ(motion.to.tip_mm.y, 0);
    // Angles and tip advance uniformly, so the tip determines the angles.
    const double s = motion.to.tip_mm.x / 10;
    expect_near(motion.to.axis,
                table_axis(machine_of(MachineKinematics::kXyzacTrt), {30 * s, 0, 90 * s}), 2e-9);
    EXPECT_NEAR(duration, s, 1e-6);
    // At half of each motion the whole tool is within the tolerance.
    const Vec3 half = turned_axis(motion.from.axis, motion.to.axis, 0.5);
    const double m = (motion.from.tip_mm.x + motion.to.tip_mm.x) / 20;
    const Vec3 truth = table_axis(machine_of(MachineKinematics::kXyzacTrt), {30 * m, 0, 90 * m});
    EXPECT_LE(60 * length(half - truth), 0.001 + 1e-6);
  }
  expect_near(program.motions.back().to.axis,
              {std::sin(30 * kRadPerDeg), 0, std::cos(30 * kRadPerDeg)}, 1e-9);
}

TEST(MachineKinematics, FullTurnsOfTheTableAreKept) {
  // Start and end axis are equal; between them the tool axis moves on a cone.
  const Program program =
      gcode(scene_for("xyzac-trt"), "T1 M6\nG43.4\nG0 X0 Y0 Z0 A20 C0\nG1 C1440 F600\nM2\n");
  double turned = 0;
  for (const ProgramMotion& motion : program.motions)
    turned += angle_between(normalized(motion.from.axis), normalized(motion.to.axis));
  EXPECT_NEAR(turned, 4 * 2 * std::numbers::pi * std::sin(20 * kRadPerDeg), 0.02);
}

TEST(MachineKinematics, WorkpieceTurnsUnderTheToolWithoutToolCenterPoint) {
  const Program program =
      gcode(scene_for("xyzac-trt", 0.001), "T1 M6\nG0 X10 Y0 Z0 A0 C0\nG1 C90 F600\nM2\n");
  ASSERT_GT(program.motions.size(), 4u);
  for (const ProgramMotion& motion : program.motions) {
    EXPECT_NEAR(std::hypot(motion.to.tip_mm.x, motion.to.tip_mm.y), 10, 2e-6);
    const Vec3 middle = (motion.from.tip_mm + motion.to.tip_mm) * 0.5;
    EXPECT_GE(std::hypot(middle.x, middle.y), 10 - 0.001);
  }
  expect_near(program.motions.back().to.tip_mm, {0, -10, 0}, 1e-6);
}

TEST(MachineKinematics, SwitchingToolCenterPointDoesNotMoveTheTool) {
  const Program program = gcode(scene_for("xyzac-trt"),
                                "T1 M6\nG0 X10 Y0 Z0 A0 C90\nG4 P1\nM428\nG91 G1 X1 F600\n"
                                "M429\nX1\nM2\n");
  ASSERT_EQ(program.motions.size(), 3u);
  expect_near(program.motions[0].to.tip_mm, {0, -10, 0}, 1e-9);
  expect_near(program.motions[1].to.tip_mm, {1, -10, 0}, 1e-9);
  expect_near(program.motions[2].to.tip_mm, {1, -11, 0}, 1e-9);
}

TEST(MachineKinematics, ToolVectorTakesTheAxisFromIJK) {
  const Scene scene = scene_for("tool-vector");
  const Program program =
      gcode(scene, "T1 M6\nG0 X0 Y0 Z0 I0 J3 K4\nG1 X1 F60\nI0 J0 K1 F90\nX2 I1 J0 K0\nM2\n");
  ASSERT_EQ(program.motions.size(), 3u);
  EXPECT_EQ(program.motions[0].from.axis, (Vec3{0, 0.6, 0.8}));
  EXPECT_EQ(program.motions[0].to.axis, (Vec3{0, 0.6, 0.8}));
  // A feed without travel of the tip is in degrees per minute.
  EXPECT_NEAR(program.motions[1].duration_s, 60 * std::atan2(0.6, 0.8) / kRadPerDeg / 90, 1e-9);
  EXPECT_EQ(program.motions[2].to.axis, (Vec3{1, 0, 0}));
  const std::string start = "T1 M6\nG0 X0 Y0 Z0\n";
  EXPECT_THAT(error_of(scene, "p.ngc", start + "G1 X1 I1 F1\n").reason, HasSubstr("all three"));
  EXPECT_THAT(error_of(scene, "p.ngc", start + "G1 X1 I0 J0 K0 F1\n").reason,
              HasSubstr("other than 0 0 0"));
  EXPECT_THAT(error_of(scene, "p.ngc", start + "G1 X1 I0 J0 K-1 F1\n").reason,
              HasSubstr("opposite"));
  EXPECT_THAT(error_of(scene, "p.ngc", start + "G1 X1 A1 F1\n").word, "A1");
}

TEST(MachineKinematics, TurnsBeyondTheKernelLimitAreHalved) {
  const Program program =
      gcode(scene_for("tool-vector"), "T1 M6\nG0 X0 Y0 Z0\nG1 X2 I0.1 J0 K-1 F60\nM2\n");
  ASSERT_EQ(program.motions.size(), 2u);
  EXPECT_EQ(program.motions[0].to.tip_mm, (Vec3{1, 0, 0}));
  EXPECT_EQ(program.motions[0].to, program.motions[1].from);
}

TEST(MachineKinematics, AxesOfOtherMachinesAreRejected) {
  EXPECT_EQ(error_of(scene_for("xyzac-trt"), "p.ngc", "G0 B1\n").word, "B1");
  EXPECT_EQ(error_of(scene_for("xyzbc-trt"), "p.ngc", "G0 A1\n").word, "A1");
  EXPECT_THAT(error_of(scene_for("xyzac-trt"), "p.ngc", "T1 M6\nG0 X0 Y0 Z0\nG0 C1&\n").word, "&");
  EXPECT_THAT(error_of(scene_for("xyzac-trt"), "p.ngc", "T1 M6\nG0 X0 Y0 Z0\nG0 C99999\n").reason,
              HasSubstr("degrees in one block"));
}

}  // namespace
}  // namespace kerf::kinematics_test
