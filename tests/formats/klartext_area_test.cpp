// SPDX-License-Identifier: Apache-2.0
// Pockets, studs, patterns, approaches and departures of HEIDENHAIN Klartext: removed volumes and
// paths.
#include "tests/formats/carved_volume.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::klartext_area_test {
namespace {

using std::numbers::pi;
using test::scene_for;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

// Tool 2 is a flat mill of 10 mm.
const std::string kHead = "BEGIN PGM T MM\nTOOL CALL 2 Z S1000\nL X+0 Y+0 Z+5 R0 FMAX M3\n";

std::expected<Program, ProgramError> read(const std::string& body) {
  return parse_program("p.h", kHead + body + "END PGM T MM\n", scene_for("xyz"));
}

double removed(const std::string& body) {
  const auto program = read(body);
  EXPECT_TRUE(program) << to_string(program.error());
  return program ? test::removed_mm3(scene_for("xyz"), *program) : 0;
}

std::vector<Vec3> ends(const std::string& body) {
  const auto program = read(body);
  EXPECT_TRUE(program) << to_string(program.error());
  return program ? test::rounded_ends(*program) : std::vector<Vec3>{};
}

std::string refused(const std::string& body) {
  const auto program = read(body);
  return program ? "" : to_string(program.error());
}

const std::string kDepth =
    " Q201=-6 ;DEPTH ~ \n Q202=2.5 ;PLUNGING DEPTH ~ \n Q206=150 ~\n Q207=500 ~\n Q200=2 ~\n "
    "Q203=+0 "
    "~\n Q204=20 ~\n Q370=1\n";

TEST(KlartextArea, RectangularPocketsHaveRoundCorners) {
  const std::string pocket =
      "CYCL DEF 251 RECTANGULAR POCKET ~\n Q215=0 ~\n Q218=60 ~\n Q219=40 ~\n "
      "Q220=8 ~\n Q368=0 ~\n Q224=+30 ~\n Q367=0 ~\n" +
      kDepth;
  const double exact = 6 * (60 * 40 - (4 - pi) * 64);
  EXPECT_NEAR(removed(pocket + "L X+5 Y-3 FMAX M99\n") / exact, 1, 0.02);
  // Measured from its lower left corner.
  std::string corner = pocket;
  corner.replace(corner.find("Q367=0"), 6, "Q367=1");
  corner.replace(corner.find("Q224=+30"), 8, "Q224=+0");
  double left = 0, right = 0;
  for (const Vec3 p : ends(corner + "L X-20 Y-20 FMAX M99\n")) {
    if (p.z > -1) continue;
    left = std::min(left, p.x);
    right = std::max(right, p.x);
  }
  EXPECT_NEAR(left, -15, 1e-9);
  EXPECT_NEAR(right, 35, 1e-9);
}

TEST(KlartextArea, RoughingLeavesTheAllowances) {
  const double rough = removed(
      "CYCL DEF 252 CIRCULAR POCKET ~\n Q215=1 ~\n Q223=40 ~\n Q368=1 ~\n "
      "Q369=0.5 ~\n" +
      kDepth + "L X+5 Y-3 FMAX M99\n");
  EXPECT_NEAR(rough / (5.5 * pi * 19 * 19), 1, 0.02);
  const double wall = removed("CYCL DEF 252 ~\n Q215=2 ~\n Q223=40 ~\n Q368=1 ~\n Q369=0 ~\n" +
                              kDepth + "L X+5 Y-3 FMAX M99\n");
  EXPECT_NEAR(wall / (6 * pi * (20 * 20 - 10 * 10)), 1, 0.02);
}

TEST(KlartextArea, SlotsAndStuds) {
  EXPECT_NEAR(removed("CYCL DEF 253 SLOT ~\n Q215=0 ~\n Q218=50 ~\n Q219=12 ~\n Q374=45 ~\n" +
                      kDepth + "CYCL CALL POS X+0 Y+0 Z+0 FMAX\n") /
                  (6 * (38 * 12 + pi * 36)),
              1, 0.02);
  const double ring = removed(
      "CYCL DEF 254 CIRCULAR SLOT ~\n Q215=0 ~\n Q219=12 ~\n Q375=60 ~\n "
      "Q367=0 ~\n Q216=+1 ~\n Q217=+2 ~\n Q376=10 ~\n Q248=60 ~\n "
      "Q378=180 ~\n Q377=2 ~\n" +
      kDepth + "CYCL CALL\n");
  EXPECT_NEAR(ring / (2 * 6 * (pi / 6 * (36 * 36 - 24 * 24) + pi * 36)), 1, 0.02);
  // The blank minus the stud, within a stock as large as the blank.
  const double stud = removed(
      "CYCL DEF 256 RECTANGULAR STUD ~\n Q218=50 ~\n Q424=100 ~\n Q219=40 "
      "~\n Q425=100 ~\n Q220=5 ~\n Q368=0 ~\n" +
      kDepth + "L X+0 Y+0 FMAX M99\n");
  EXPECT_NEAR(stud / (6 * (10000 - 50 * 40 + (4 - pi) * 25)), 1, 0.02);
}

TEST(KlartextArea, PatternsCallTheCycleAtTheirPoints) {
  const auto holes = [](const std::string& body) {
    std::vector<Vec3> bottoms;
    for (const Vec3 p : ends(body))
      if (p.z == -4) bottoms.push_back(p);
    return bottoms;
  };
  const std::string drill =
      "CYCL DEF 200 DRILLING ~\n Q200=2 ~\n Q201=-4 ~\n Q206=150 ~\n Q203=0\n";
  EXPECT_THAT(holes(drill + "CYCL DEF 220 POLAR PATTERN ~\n Q216=+10 ~\n Q217=+0 ~\n Q244=20 ~\n "
                            "Q245=0 ~\n Q246=360 ~\n Q247=0 ~\n Q241=4 ~\n Q200=2 ~\n Q203=0 ~\n "
                            "Q204=5 ~\n Q301=1\n"),
              ElementsAre(Vec3{20, 0, -4}, Vec3{10, 10, -4}, Vec3{0, 0, -4}, Vec3{10, -10, -4}));
  EXPECT_THAT(holes(drill + "CYCL DEF 221 CARTESIAN PATTERN ~\n Q225=1 ~\n Q226=2 ~\n Q237=10 ~\n "
                            "Q238=5 ~\n Q242=2 ~\n Q243=2 ~\n Q224=90 ~\n Q200=2 ~\n Q203=0 ~\n "
                            "Q204=5 ~\n Q301=0\n"),
              ElementsAre(Vec3{1, 2, -4}, Vec3{1, 12, -4}, Vec3{-4, 12, -4}, Vec3{-4, 2, -4}));
  EXPECT_THAT(refused("CYCL DEF 220 ~\n Q241=4\n"), HasSubstr("requires a cycle"));
}

TEST(KlartextArea, RejectsUnsupportedWords) {
  EXPECT_THAT(refused("CYCL DEF 251 ~\n Q218=9 ~\n Q219=9 ~\n" + kDepth + "CYCL CALL\n"),
              HasSubstr("does not fit into the pocket"));
  EXPECT_THAT(
      refused("CYCL DEF 254 ~\n Q367=1 ~\n Q219=12 ~\n Q375=60 ~\n" + kDepth + "CYCL CALL\n"),
      HasSubstr("Q367"));
  EXPECT_THAT(
      refused("CYCL DEF 256 ~\n Q218=9 ~\n Q219=9 ~\n Q220=-2 ~\n" + kDepth + "CYCL CALL\n"),
      HasSubstr("Q220"));
  EXPECT_THAT(
      refused("CYCL DEF 251 ~\n Q218=90 ~\n Q219=90 ~\n Q201=-9 ~\n Q202=0.001 ~\n Q200=2 ~\n "
              "Q203=0 ~\n Q207=9\nCYCL CALL\n"),
      HasSubstr("100000 moves"));
}

// The contour runs along Y. The tool of 10 mm is to its left, at X -5.
TEST(KlartextApproach, LineEndsNextToTheContour) {
  const std::string behind = "L Y+20\nDEP LT LEN5\n";
  const auto lt = ends("L X-30 Y-30 Z-1 R0 F500\nAPPR LT X+0 Y+0 LEN10 RL F300\n" + behind);
  EXPECT_THAT(lt, ElementsAre(Vec3{-30, -30, -1}, Vec3{-5, -10, -1}, Vec3{-5, 0, -1},
                              Vec3{-5, 20, -1}, Vec3{-5, 25, -1}));
  const auto ln = ends(
      "L X-30 Y-30 Z-1 R0 F500\nAPPR LN X+0 Y+0 LEN10 RL F300\nL Y+20\nDEP LN LEN7\nL X+50 R0\n");
  EXPECT_THAT(ln, ElementsAre(Vec3{-30, -30, -1}, Vec3{-15, 0, -1}, Vec3{-5, 0, -1},
                              Vec3{-5, 20, -1}, Vec3{-12, 20, -1}, Vec3{50, 20, -1}));
  const auto right = ends(
      "L X-30 Y-30 Z-1 R0 F500\nAPPR LN X+0 Y+0 LEN10 RR F300\nL Y+20\nDEP LN "
      "LEN7\n");
  EXPECT_EQ(right.back(), (Vec3{12, 20, -1}));
}

TEST(KlartextApproach, ArcsAreTangentialToTheContour) {
  // About (-15, 0) with a radius of 10: counterclockwise on the left side.
  const auto ct = ends(
      "L X-30 Y-30 Z-1 R0 F500\nAPPR CT X+0 Y+0 CCA90 R+10 RL F300\nL Y+20\nDEP CT CCA90 R+10\n");
  EXPECT_THAT(ct, Contains(Vec3{-15, -10, -1}));
  EXPECT_EQ(ct.back(), (Vec3{-15, 30, -1}));
  for (const Vec3 p : ct) {
    if (p.y > -10 && p.y < 0) {
      EXPECT_NEAR(std::hypot(p.x + 15, p.y), 10, 0.01);
    }
  }
  // From (-25, -40) the tangent of that circle is the line X -25: half a turn to (-5, 0).
  const auto lct = ends(
      "L X-25 Y-40 Z-1 R0 F500\nAPPR LCT X+0 Y+0 R10 RR F300\nL Y-20\nDEP LCT X-40 Y-30 R10\n");
  for (const Vec3 p : lct) EXPECT_LE(p.x, -5 + 1e-9);
  EXPECT_EQ(lct.back(), (Vec3{-40, -30, -1}));
  EXPECT_THAT(lct, Contains(Vec3{-5, 0, -1}));
  EXPECT_THAT(lct, Contains(Vec3{-25, 0, -1}));
}

// A line with RL ends next to the contour, across the first element, however short that is. Moves
// along Z may come between.
TEST(KlartextApproach, ALineEndsAcrossTheFirstElement) {
  const auto path =
      ends("L X-3 Y+2 R0 F500\nL X+0 Y+0 RL\nL Z-2 F100\nL Z-3\nL Y+20 F500\nL X+10\nL Z+5 R0\n");
  EXPECT_THAT(std::vector<Vec3>(path.begin(), path.begin() + 5),
              ElementsAre(Vec3{-3, 2, 5}, Vec3{-5, 0, 5}, Vec3{-5, 0, -2}, Vec3{-5, 0, -3},
                          Vec3{-5, 20, -3}));
  EXPECT_EQ(path[path.size() - 2], (Vec3{10, 25, -3}));
  // Without a contour it ends across the line.
  EXPECT_THAT(ends("L X-30 Y+0 R0 F500\nL X+0 RL\nL Z+9 R0\n"),
              ElementsAre(Vec3{-30, 0, 5}, Vec3{0, 5, 5}, Vec3{0, 5, 9}));
  EXPECT_EQ(ends("L X-30 Y+0 R0 F500\nL X+0 RR\n").back(), (Vec3{0, -5, 5}));
}

// The arc is smaller than the tool, so the path can only be that of the tool's center.
TEST(KlartextApproach, PathsTooTightForTheToolAreThoseOfItsCenter) {
  const auto program = test::value_of(read(
      "L X-30 Y+0 R0 F500\nL X+0 RL\nL X+20\nCC X+20 Y+3\nC X+20 Y+6 DR+\nL X+0\nL Y+30 R0\n"));
  EXPECT_THAT(program.warnings, Contains(HasSubstr("RL and RR displace by 0")));
  EXPECT_EQ(program.motions[1].to.tip_mm, (Vec3{0, 0, 5}));
  EXPECT_EQ(program.motions.back().to.tip_mm, (Vec3{0, 30, 5}));
}

// The programs "Linear" and "Circular" of the manual: the tool never enters the contour.
TEST(KlartextApproach, TheFirstElementMayBeAnArcOrACorner) {
  const auto path = ends(
      "L X-40 Y+0 Z-1 R0 F500\nCC X+0 Y+0\nAPPR LCT X-20 Y+0 R5 RL F300\nC X-20 Y+0 DR-\nDEP LCT "
      "X-40 Y+0 R5 F500\n");
  double least = 100;
  for (std::size_t i = 1; i < path.size(); ++i)
    least = std::min(least, std::hypot(path[i].x, path[i].y));
  EXPECT_NEAR(least, 25, 0.01);
  const auto corner = ends(
      "L X-40 Y-40 Z-1 R0 F500\nAPPR LT X-20 Y-20 LEN10 RL F300\nL Y+20\nRND R5\nL X+20\nDEP LT "
      "LEN10\n");
  EXPECT_THAT(corner, Contains(Vec3{-25, -30, -1}));
  EXPECT_EQ(corner.back(), (Vec3{30, 25, -1}));
}

TEST(KlartextApproach, RejectsUnsupportedWords) {
  const std::string head = "L X-40 Y-40 Z-1 R0 F500\n";
  EXPECT_THAT(refused(head + "APPR PLT PR+5 PA+3 LEN9 RL\n"), HasSubstr("APPR PLT"));
  EXPECT_THAT(refused(head + "APPR LN X+0 Y+0 LEN9 R0\n"), HasSubstr("RL or RR"));
  EXPECT_THAT(refused(head + "APPR LT X+0 Y+0 LEN9 RL\n"), HasSubstr("followed by a contour"));
  EXPECT_THAT(refused(head + "APPR LCT X+0 Y+0 RL\nL Y+9\n"), HasSubstr("R"));
  EXPECT_THAT(refused(head + "APPR LCT X+0 Y+0 R90 RL\nL Y+9\n"), HasSubstr("within its arc"));
  EXPECT_THAT(refused(head + "APPR LT X+0 Y+0 LEN9 RL\nL Z-9\n"), HasSubstr("by a contour"));
  EXPECT_THAT(refused(head + "L X+0\nDEP LN LEN5\n"), HasSubstr("RL or RR"));
}

}  // namespace
}  // namespace kerf::klartext_area_test
