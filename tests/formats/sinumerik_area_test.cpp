// SPDX-License-Identifier: Apache-2.0
// Pockets, spigots, faces and swiveled planes of SINUMERIK: removed volumes and paths.
#include "tests/formats/carved_volume.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::sinumerik_area_test {
namespace {

using std::numbers::pi;
using test::scene_for;
using testing::HasSubstr;

// Tool 2 is a flat mill of 10 mm.
std::expected<Program, ProgramError> read(const std::string& body, const char* machine = "xyz") {
  GcodeEnvironment environment{.dialect = Dialect::kSiemens};
  return parse_program("p.mpf", "T2 M6\nG0 X0 Y0\nZ25 S1000 M3\nF600\n" + body + "M30\n",
                       scene_for(machine), environment);
}

double removed(const std::string& body) {
  const auto program = read(body);
  EXPECT_TRUE(program) << to_string(program.error());
  return program ? test::removed_mm3(scene_for("xyz"), *program) : 0;
}

std::string refused(const std::string& body, const char* machine = "xyz") {
  const auto program = read(body, machine);
  return program ? "" : to_string(program.error());
}

TEST(SinumerikArea, Pockets) {
  EXPECT_NEAR(removed("POCKET3(20,0,2,-6,60,40,8,5,-3,30,2.5,0,0,500,150,0,21)\n") /
                  (6 * (60 * 40 - (4 - pi) * 64)),
              1, 0.02);
  EXPECT_NEAR(removed("POCKET4(20,0,2,-6,20,5,-3,2.5,1,0.5,500,150,0,11)\n") / (5.5 * pi * 19 * 19),
              1, 0.02);
  EXPECT_NEAR(
      removed("POCKET4(20,0,2,-6,20,5,-3,2.5,1,0,500,150,0,12)\n") / (6 * pi * (20 * 20 - 10 * 10)),
      1, 0.02);
}

TEST(SinumerikArea, SpigotsAndFaces) {
  EXPECT_NEAR(removed("CYCLE76(20,0,2,,6,50,40,5,0,0,0,2.5,0,0,500,150,0,1,100,100)\n") /
                  (6 * (10000 - 50 * 40 + (4 - pi) * 25)),
              1, 0.02);
  EXPECT_NEAR(
      removed("CYCLE77(20,0,2,-6,,40,0,0,2.5,0,0,500,150,0,1,142)\n") / (6 * (10000 - pi * 400)), 1,
      0.02);
  EXPECT_NEAR(removed("CYCLE71(20,0,2,-3,-50,-50,100,100,0,2,8,5,0,500,31)\n") / (3 * 10000), 1,
              0.01);
}

TEST(SinumerikArea, RejectsUnsupportedWords) {
  EXPECT_THAT(refused("POCKET3(20,0,2,-6,60,40,8,5,-3,30,2.5,0,0,500,150,0,21,0,0,0,0,0,0,0,1)\n"),
              HasSubstr("later controls"));
  EXPECT_THAT(refused("POCKET3(20,0,2,-6,-60,40,8,5,-3)\n"), HasSubstr("from the center"));
  EXPECT_THAT(refused("POCKET3(20,0,2,,60,40,8,5,-3)\n"), HasSubstr("requires DP"));
  EXPECT_THAT(refused("POCKET3(20,0,2,-6,9,40,8,5,-3)\n"), HasSubstr("does not fit"));
  EXPECT_THAT(refused("SLOT1(20,0,2,-6,,3,30,12,0,0,20,0,90)\n"), HasSubstr("SLOT1"));
}

// B 90 about Y: the plane's normal is X of the workpiece, its X is -Z.
TEST(SinumerikSwivel, Cycle800TurnsThePlane) {
  const std::string program =
      "CYCLE800(1,\"TC\",0,57,50,0,-10,0,90,0,1,2,3,-1)\nG0 X4 Y5\nZ6\nG1 Z-1 F100\nG2 X14 Y5 I5 "
      "J0\n"
      "CYCLE800(1,\"TC\",0,57,0,0,0,0,0,0,0,0,0,-1)\nG0 X0 Y0\nZ9\nG1 Z8\n";
  for (const char* machine : {"tool-vector", "xyzbc-trt", "xyzac-trt"}) {
    const auto read_program = test::value_of(read(program, machine));
    const auto& motions = read_program.motions;
    const auto near = [](Vec3 a, Vec3 b) { return length(a - b) < 1e-6; };
    // Origin: (50, 0, -10) + 1 * (0, 0, -1) + 2 * (0, 1, 0) + 3 * (1, 0, 0).
    EXPECT_TRUE(near(motions[0].from.tip_mm, {53 + 6, 2 + 5, -11 - 4})) << machine;
    EXPECT_TRUE(near(motions[0].to.tip_mm, {53 - 1, 2 + 5, -11 - 4})) << machine;
    EXPECT_TRUE(near(motions[0].to.axis, {1, 0, 0})) << machine;
    EXPECT_TRUE(near(motions[motions.size() - 2].to.tip_mm, {52, 7, -25})) << machine;
    EXPECT_TRUE(near(motions.back().to.tip_mm, {0, 0, 8})) << machine;
    EXPECT_TRUE(near(motions.back().to.axis, {0, 0, 1})) << machine;
  }
}

TEST(SinumerikSwivel, AnglesTurnAboutXYAndZInTurn) {
  const auto program = test::value_of(
      read("CYCLE800(0,\"\",0,57,0,0,0,30,40,50,0,0,0,1)\nG0 X0 Y0 Z0\nG1 X10 F100\nZ10\n",
           "tool-vector"));
  const double rad = pi / 180, ca = std::cos(30 * rad), sa = std::sin(30 * rad),
               cb = std::cos(40 * rad), sb = std::sin(40 * rad), cc = std::cos(50 * rad),
               sc = std::sin(50 * rad);
  // Rx Ry Rz applied to X: Rz, then Ry, then Rx about the fixed axes.
  const Vec3 z{cc, sc, 0}, y{cb * z.x, z.y, -sb * z.x};
  const Vec3 x{y.x, ca * y.y - sa * y.z, sa * y.y + ca * y.z};
  EXPECT_LT(length(program.motions[0].to.tip_mm - x * 10), 1e-5);
  const Vec3 normal{sb, -sa * cb, ca * cb};
  EXPECT_LT(length(program.motions[1].to.tip_mm - (x + normal) * 10), 1e-5);
}

TEST(SinumerikSwivel, RejectsUnsupportedWords) {
  const std::string swivel = "CYCLE800(0,\"\",0,57,0,0,0,0,30,0,0,0,0,-1)\n";
  EXPECT_THAT(refused(swivel), HasSubstr("the machine xyz cannot"));
  const char* machine = "xyzbc-trt";
  EXPECT_THAT(refused("CYCLE800(0,\"\",0,39,0,0,0,0,30,0,0,0,0,-1)\n", machine), HasSubstr("57"));
  EXPECT_THAT(refused("CYCLE800(0,\"\",1,57,0,0,0,0,30,0,0,0,0,-1)\n", machine), HasSubstr("_ST"));
  EXPECT_THAT(refused("CYCLE800(0,\"\",0,57,0,0,0,0,30,0,0,0,0,0)\n", machine), HasSubstr("_DIR"));
  EXPECT_THAT(refused(swivel + "G1 Z-1\n", machine), HasSubstr("must be programmed with G0"));
  EXPECT_THAT(refused(swivel + "G0 B5\n", machine), HasSubstr("turns a table"));
  EXPECT_THAT(refused(swivel + "TRAORI\n", machine), HasSubstr("TRAORI"));
  EXPECT_THAT(refused(swivel + "CYCLE800()\nG0 X0 Y0 Z5\nG1 Z-1\n", machine),
              HasSubstr("left the tables turned"));
}

}  // namespace
}  // namespace kerf::sinumerik_area_test
