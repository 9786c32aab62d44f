// SPDX-License-Identifier: Apache-2.0
// LN of HEIDENHAIN Klartext: lines at whose end the tool has turned to a vector.
#include "server/formats/program_facts.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::klartext_vector_test {
namespace {

using test::scene_for;
using testing::HasSubstr;

const std::string kHead =
    "0 BEGIN PGM T MM\n1 TOOL CALL 1 Z S1000\n2 L X+0 Y+0 Z+5 R0 FMAX M3\n3 L Z-1 F100\n";

std::expected<Program, ProgramError> read(const std::string& body, const char* machine) {
  return parse_program("p.h", kHead + body + "END PGM T MM\n", scene_for(machine));
}

Program carved(const std::string& body, const char* machine) {
  auto program = read(body, machine);
  EXPECT_TRUE(program) << to_string(program.error());
  return program ? *std::move(program) : Program{};
}

std::string refused(const std::string& body, const char* machine = "tool-vector") {
  const auto program = read(body, machine);
  return program ? "" : to_string(program.error());
}

double angle_deg(Vec3 a, Vec3 b) {
  return std::atan2(length(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
}

TEST(KlartextVectors, TurnTheToolAlongTheGreatCircle) {
  const Vec3 tilted = normalized({0.3, -0.4, 0.8});
  const Program program =
      carved("LN X+20 Y+10 Z-3 TX+0.3 TY-0.4 TZ+0.8 M128\nL X+30\n", "tool-vector");
  const ToolPose end = program.motions.back().to;
  EXPECT_EQ(end.tip_mm, (Vec3{30, 10, -3}));  // L keeps the axis
  EXPECT_NEAR(angle_deg(end.axis, tilted), 0, 1e-4);
  const Vec3 across = normalized(cross({0, 0, 1}, tilted));
  double before = 0;
  for (const ProgramMotion& motion : program.motions) {
    EXPECT_NEAR(dot(motion.to.axis, across), 0, 1e-6);
    EXPECT_GE(angle_deg({0, 0, 1}, motion.to.axis), before - 1e-6);
    before = angle_deg({0, 0, 1}, motion.to.axis);
    const Vec3 tip = motion.to.tip_mm;
    if (tip.x <= 0 || tip.x > 20) continue;
    EXPECT_NEAR(tip.y, tip.x / 2, 2e-3);
    EXPECT_NEAR(before, angle_deg({0, 0, 1}, tilted) * tip.x / 20, 1e-3);
  }
}

TEST(KlartextVectors, TurnTablesLikeTheirAngles) {
  const std::string vector =
      "M128\nLN X+20 TX+0 TY+0.5 TZ+0.8660254037844386 F100\nLN X+40 TX+0 TY+0 TZ+1\n";
  const Program by_vector = carved(vector, "xyzac-trt");
  const Program by_angles = carved("M128\nL X+20 A+30 F100\nL X+40 A+0\n", "xyzac-trt");
  ASSERT_EQ(by_vector.motions.size(), by_angles.motions.size());
  for (std::size_t n = 0; n < by_angles.motions.size(); ++n) {
    const ToolPose &a = by_vector.motions[n].to, &b = by_angles.motions[n].to;
    EXPECT_NEAR(length(a.tip_mm - b.tip_mm), 0, 1e-6);
    EXPECT_NEAR(angle_deg(a.axis, b.axis), 0, 1e-4);
  }
}

TEST(KlartextVectors, UseTheNormalWithoutAToolVector) {
  const auto end = [](const std::string& words) {
    return carved("M128\nLN X+20 " + words + " F100\n", "tool-vector").motions.back().to.axis;
  };
  EXPECT_NEAR(angle_deg(end("NX+0 NY+1 NZ+1"), {0, 1, 1}), 0, 1e-4);
  EXPECT_NEAR(angle_deg(end("NX+0 NY+1 NZ+1 TX+1 TY+0 TZ+2"), {1, 0, 2}), 0, 1e-4);
  EXPECT_EQ(end(""), (Vec3{0, 0, 1}));
}

TEST(KlartextVectors, TurnWithTheProgram) {
  const Program program = carved(
      "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+90\nM128\nLN X+20 Y+0 TX+1 TY+0 TZ+1 F100\n",
      "tool-vector");
  EXPECT_NEAR(length(program.motions.back().to.tip_mm - Vec3{0, 20, -1}), 0, 2e-3);
  EXPECT_NEAR(angle_deg(program.motions.back().to.axis, {0, 1, 1}), 0, 1e-4);
}

TEST(KlartextVectors, NeedAMachineThatTurnsTheTool) {
  EXPECT_EQ(refused("M128\nLN X+20 TX+0 TY+0 TZ+1 F9\n", "xyz"), "");
  EXPECT_THAT(refused("M128\nLN X+20 TX+1 TY+0 TZ+1 F9\n", "xyz"), HasSubstr("the machine xyz"));
  const auto facts = test::value_of(
      program_facts("p.h", kHead + "M128\nLN X+20 TX+1 TY+0 TZ+1 F9\nEND PGM T MM\n", {}));
  EXPECT_EQ(facts.kinematics, MachineKinematics::kXyzacTrt);
}

TEST(KlartextVectors, AreRejectedIfAmbiguous) {
  EXPECT_THAT(refused("LN X+20 TX+1 TY+0 TZ+1 F9\n"), HasSubstr("requires M128"));
  EXPECT_THAT(refused("M128\nLN X+20 TX+1 TZ+1 F9\n"), HasSubstr("requires all of TX, TY and TZ"));
  EXPECT_THAT(refused("M128\nLN X+20 NX+0 NY+0 NZ+0 F9\n"), HasSubstr("other than 0"));
  EXPECT_THAT(refused("M128\nLN X+20 TX+0 TY+0 TZ-1 F9\n"), HasSubstr("opposite"));
  EXPECT_THAT(refused("M128\nLN X+20 A+3 F9\n"), HasSubstr("not a word of LN"));
  EXPECT_THAT(refused("M128\nLN X+20 TX+1 TY+0 TZ+1\n"
                      "L X+1 RL\nLN X+2 TX+0 TY+0 TZ+1\n"),
              HasSubstr("beside a contour"));
  EXPECT_THAT(refused("PLANE SPATIAL SPA+10 SPB+0 SPC+0 TURN F9\nL X+0 Y+0 Z+5 FMAX\nM128\n"
                      "LN X+2 TX+0 TY+0 TZ+1 F9\n"),
              HasSubstr("tilted plane"));
}

}  // namespace
}  // namespace kerf::klartext_vector_test
