// SPDX-License-Identifier: Apache-2.0
// Words of postprocessors and shops that a control does not need, and programs recognized by them.
#include "server/formats/derived_scene.h"
#include "server/formats/gcode/dialect_choice.h"
#include "server/formats/gcode/turning.h"
#include "server/formats/text_lines.h"
#include "tests/formats/dialect_runs.h"
#include "tests/formats/post_fixture.h"
#include "tests/support/test.h"

namespace kerf::program_words_test {
namespace {

using test::as;
using test::fanuc;
using test::haas;
using test::refused;
using test::scene_for;
using test::text_of;
using testing::Contains;
using testing::HasSubstr;

TEST(ProgramWords, MessagesOfMarlinAreText) {
  EXPECT_EQ(fanuc("M117 Load 6mm End Mill!\nG0 X1\nN5 M118 X99 done\nM0 Insert tool\nX2\nM30\n"),
            "R 1 0 0, R 2 0 0");
  EXPECT_EQ(fanuc("G0 X1\nM0 X5\nM30\n"), "R 1 0 0, R 5 0 0") << "a word is none";
  EXPECT_NE(refused("M117 Load\nG0 X1\nM2\n", Dialect::kLinuxcnc), "");
}

TEST(ProgramWords, SecondToolOfABlockIsPreselected) {
  const auto calls = test::calls_of("T01T02M06\nG0 X1\nM30\n", as(Dialect::kFanuc));
  ASSERT_EQ(calls.size(), 2U);
  EXPECT_EQ(calls[0].kind, 'T');
  EXPECT_EQ(calls[0].value, 1);
  EXPECT_NE(refused("T1 T2 M6\nM2\n", Dialect::kLinuxcnc), "");
}

TEST(ProgramWords, EndOfNormalDirectionControlCausesNoMotion) {
  EXPECT_EQ(fanuc("G49 G40.1 G17\nG0 X1\nM30\n"), "R 1 0 0");
  EXPECT_NE(refused("G40.1\nM2\n", Dialect::kLinuxcnc), "");
}

TEST(ProgramWords, UseOfToolsCountsAsZero) {
  EXPECT_EQ(haas("IF [#5401 GE 6000] THEN #3000=15 (EXPIRED)\nG0 X[#5501+1]\nX[#5701+2]\nM30\n"),
            "R 1 0 0, R 2 0 0");
  EXPECT_THAT(refused("G0 X#5601\n", Dialect::kHaas), HasSubstr("#5601")) << "a limit";
  const auto program =
      test::value_of(parse_program("p.nc", "G21\nT1 M6\nG0 X0 Y0 Z5\nG1 X[#5401+1.] F9\nM30\n",
                                   scene_for("xyz"), as(Dialect::kHaas)));
  EXPECT_THAT(program.warnings, Contains(HasSubstr("they are new")));
}

TEST(ProgramWords, LinesMayEndWithCrAlone) {
  const std::string text =
      "%\nO1\nG21 G90 G17\nT1 M6\n(6MM ENDMILL)\nG0 X-70. Y0. Z-4.\nG1 X70. F600.\nM30\n%\n";
  std::string carriage = text;
  std::ranges::replace(carriage, '\n', '\r');
  const auto with_lf = derive_scene("p.nc", text, {}, {});
  const auto with_cr = derive_scene("p.nc", carriage, {}, {});
  ASSERT_TRUE(with_lf);
  ASSERT_TRUE(with_cr) << with_cr.error();
  EXPECT_EQ(scene_json(with_cr->scene), scene_json(with_lf->scene));
  TextLines mixed("a\rb\r\nc");
  ASSERT_TRUE(mixed.next());
  EXPECT_EQ(mixed.line(), "a\rb\r") << "a CR in a text with LF ends no line";
}

TEST(ProgramWords, ANumberBelowEveryDoubleIsZero) {
  const std::string start = "UNITS/MM\nLOADTL/1\nFEDRAT/600,MMPM\nFROM/0,0,0\n";
  const auto program = test::value_of(
      parse_program("p.apt", start + "GOTO/1E-400,-2.5E-999,1\nFINI\n", scene_for("xyz")));
  EXPECT_EQ(program.motions.at(0).to.tip_mm, (Vec3{0, 0, 1}));
  EXPECT_FALSE(parse_program("p.apt", start + "GOTO/1E400,0,1\nFINI\n", scene_for("xyz")));
}

TEST(ProgramWords, SinumerikWordsAreRecognized) {
  const auto judged = [](const std::string& name, const std::string& text) {
    const auto choice = choose_dialect(name, text);
    return choice ? choice->dialect : Dialect::kAuto;
  };
  EXPECT_EQ(judged("p.mpf", "N10 G71 G90\nG0 X1\n"), Dialect::kSiemens);
  EXPECT_EQ(judged("P.SPF", "G0 X1\n"), Dialect::kSiemens);
  for (const char* word :
       {"TRANS X10 Y5", "AROT RPL=90", "ATRANS X1", "MIRROR X0", "N5 ROT Z30", "G0 AP=0 RP=30"})
    EXPECT_EQ(judged("p.nc", std::string("G0 X1\n") + word + "\n"), Dialect::kSiemens) << word;
  EXPECT_EQ(judged("p.nc", "O1000\n(TRANS MIRROR ROT)\nG0 X1\n"), Dialect::kFanuc);
  EXPECT_EQ(judged("p.nc", "O1000 ROT\nG0 X1\n"), Dialect::kFanuc);
}

TEST(ProgramWords, LatheWordsAreNamed) {
  const std::string turned = "%\nO0060\nT101\nG50 S3000\nG54 G0 X2.2 Z0.1\nG1 X-0.06 F.008\nM30\n";
  EXPECT_EQ(sign_of_turning(turned), "line 4 has G50 S");
  EXPECT_NE(sign_of_turning("G0 X1 Z1\nG71 P10 Q20 U0.01 W0.005\n"), "");
  EXPECT_NE(sign_of_turning("G0 X1 Z1\nG96 S400\n"), "");
  EXPECT_NE(sign_of_turning("G0 X1 Z1\nG1 U-2. W-1.\n"), "");
  EXPECT_EQ(sign_of_turning(turned + "G0 Y5.\n"), "") << "a lathe of two axes has no Y";
  EXPECT_EQ(sign_of_turning("G0 X1 Z1\nG50 (S3000)\nG1 X5 F9\n"), "") << "the end of a scaling";
  EXPECT_EQ(sign_of_turning("G0 X1 Z1\nG83 Z-5 R1 Q2 F9\n"), "");
  const auto error = test::error_of(derive_scene("p.nc", turned, {}, {}));
  EXPECT_THAT(error, HasSubstr("is a program for a lathe (line 4 has G50 S)"));
}

TEST(ProgramWords, CutBeforeTheFirstToolChangeRequiresTheSpindlesTool) {
  const std::string text =
      "G21\nG0 X-20 Y0 Z5\nF400\nG1 Z-3\nX20\nG0 Z5\nM6 T2\nG0 X0 Y20\nG1 Z-3\nX20\nG0 Z5\nM6 T1\n"
      "G0 X0\nM2\n";
  const auto scene = test::value_of(derive_scene("p.ngc", text, {}, {}));
  const ToolId spindle = scene.scene.machine.spindle_tool;
  EXPECT_EQ(spindle, 3U) << "a number of no other tool";
  EXPECT_THAT(scene.notes, Contains(HasSubstr("--tool 3=6 states it; the program cuts with it")));
  SceneWishes wishes{.tools = {{spindle, BallShape{4, 20}}}};
  EXPECT_EQ(derive_scene("p.ngc", text, {}, wishes)->scene.tools.at(3).tool.radius_mm, 2);
  const auto again = test::value_of(parse_scene(scene_json(scene.scene), {}));
  const auto program = test::value_of(parse_program("p.ngc", text, again));
  EXPECT_EQ(program.motions.front().tool, 3U);
  EXPECT_EQ(program.motions.back().tool, 1U);
  Scene none = again;
  none.machine.spindle_tool = 0;
  EXPECT_THAT(to_string(parse_program("p.ngc", text, none).error()), HasSubstr("spindle_tool"));
  const auto loaded =
      derive_scene("p.ngc", "G21\nT1 M6\nG0 X0 Y0 Z5\nG1 Z-3 F9\nT2 M6\nX9\nM2\n", {}, {});
  EXPECT_EQ(loaded->scene.machine.spindle_tool, 0U);
}

std::string exported(const std::string& text, Post post, Dialect dialect) {
  const Scene scene = scene_for("xyz");
  const auto program = parse_program("p.nc", text, scene, as(dialect));
  EXPECT_TRUE(program) << to_string(program.error());
  return program ? text_of(*program, scene, post) : std::string();
}

TEST(Export, KeepsTheNumberOfTheProgram) {
  const std::string body = "G21 G90\nT1 M6\nG0 X0 Y0 Z5\nG1 Z-1 F99\nM30\n";
  EXPECT_THAT(exported("%\nO1234 (P)\n" + body, Post::kFanuc, Dialect::kFanuc),
              HasSubstr("\nO1234 ("));
  EXPECT_THAT(exported("%\nO00012\n" + body, Post::kHaas, Dialect::kHaas), HasSubstr("\nO00012 ("));
  EXPECT_THAT(exported(body, Post::kFanuc, Dialect::kFanuc), HasSubstr("\nO1000 ("));
}

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

TEST(Export, KeepsArcsAndReadsBackTheSameMotions) {
  const std::string text =
      "G21 G90\nT1 M6\nG0 X-20 Y0 Z5\nG1 Z-4 F300\nG2 X20 Y0 I20 J0 F600\nG2 X-20 Y0 I-20 J0\n"
      "G3 X-20 Y0 Z-8 I7.5 J3.25\nG1 X-30\nG3 X-24.5 Y5.5 R5.5\nG18 G2 X-10 Z-8 R30\nG17 G1 "
      "X0\nM2\n";
  const Scene scene = scene_for("xyz");
  for (const Post post : test::kPosts) {
    SCOPED_TRACE(std::string(rules_of(post).name));
    const auto program =
        test::value_of(parse_program("p.ngc", text, scene, as(Dialect::kLinuxcnc)));
    const std::string written = text_of(program, scene, post);
    const bool klartext = post == Post::kHeidenhain;
    EXPECT_GE(count_of(written, klartext ? " DR" : "\nG2 ") + count_of(written, "\nG3 "),
              klartext ? 3 : 6)
        << written;
    const Program again = test::read_back(scene, written, post);
    ASSERT_EQ(again.motions.size(), program.motions.size()) << written;
    for (std::size_t n = 0; n < again.motions.size(); ++n) {
      const double off = length(again.motions[n].to.tip_mm - program.motions[n].to.tip_mm);
      ASSERT_LE(off, post == Post::kLinuxcnc ? 0 : 1e-3) << n << "\n" << written;
    }
    if (klartext) continue;
    for (const char* feed : {" F300", " F600"})
      EXPECT_EQ(count_of(written, feed), 1) << "one for each change\n" << written;
  }
}

// As written by a CAM system: the radii at both ends differ by some 0.0005 mm.
TEST(Export, KeepsArcsWhoseEndsAreRounded) {
  const Scene scene = scene_for("xyz");
  const std::string text =
      "G21 G90\nT1 M6\nG0 X0 Y0 Z5\nG1 Z-1 F300\nG2 X15.858 Y1.493 I8.124 J-1.322 F600\n"
      "G3 X3.832 Y-13.491 Z-2 I-3.1 J-9.83\nM2\n";
  const auto program = test::value_of(parse_program("p.ngc", text, scene));
  const std::string written = text_of(program, scene, Post::kLinuxcnc);
  const Program again = test::read_back(scene, written, Post::kLinuxcnc);
  ASSERT_EQ(again.motions.size(), program.motions.size()) << written;
  for (std::size_t n = 0; n < again.motions.size(); ++n)
    ASSERT_EQ(again.motions[n].to, program.motions[n].to) << n << "\n" << written;
  EXPECT_EQ(count_of(written, "\nG2 "), 1) << written;
  EXPECT_EQ(count_of(written, "\nG3 "), 1) << written;
}

TEST(Export, WritesOtherPathsUnchanged) {
  Program program;
  const Scene scene = scene_for("xyz");
  const Vec3 points[] = {{0, 0, 0}, {5, 1, 0}, {9, 5, 0}, {10, 11, 0}, {8, 15, 0}};
  for (std::size_t n = 0; n + 1 < std::size(points); ++n)
    program.motions.push_back({.tool = 1,
                               .from = {points[n], {0, 0, 1}},
                               .to = {points[n + 1], {0, 0, 1}},
                               .duration_s = 1,
                               .line = 7});
  const std::string written = text_of(program, scene, Post::kLinuxcnc);
  EXPECT_EQ(count_of(written, "\nG2 ") + count_of(written, "\nG3 "), 0) << written;
}

}  // namespace
}  // namespace kerf::program_words_test
