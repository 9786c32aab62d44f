// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/parameters.h"
#include "tests/formats/canon_record.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::gcode_flow_test {
namespace {

using test::calls_of;
using test::moves_of;
using test::run_error_of;
using testing::HasSubstr;

TEST(GcodeFlow, LoopsRunWhileTheirConditionHolds) {
  EXPECT_EQ(moves_of("#1=0\no1 while [#1 lt 3]\nG0 X#1\n#1=[#1+1]\no1 endwhile\nM2\n"),
            "R 0 0 0, R 1 0 0, R 2 0 0");
  EXPECT_EQ(moves_of("#1=5\no1 do\nG0 X#1\n#1=[#1+1]\no1 while [#1 lt 7]\nM2\n"),
            "R 5 0 0, R 6 0 0");
  EXPECT_EQ(moves_of("G91\no<r> repeat [2]\nG0 X1\no<r> endrepeat\no2 repeat [0]\nG0 Y1\no2 "
                     "endrepeat\nM2\n"),
            "R 1 0 0, R 2 0 0");
}

TEST(GcodeFlow, BreakAndContinueAffectTheirOwnLoop) {
  EXPECT_EQ(
      moves_of("#1=0\no1 while [#1 lt 9]\n#1=[#1+1]\no2 if [#1 eq 2]\no1 continue\no2 "
               "endif\no3 if [#1 eq 4]\no1 break\no3 endif\nG0 X#1\no1 endwhile\nG0 Y1\nM2\n"),
      "R 1 0 0, R 3 0 0, R 3 1 0");
  EXPECT_EQ(moves_of("#1=0\no1 do\n#1=[#1+1]\no2 if [#1 eq 2]\no1 continue\no2 endif\nG0 X#1\no1 "
                     "while [#1 lt 3]\no4 do\no4 break\no4 while [1]\nM2\n"),
            "R 1 0 0, R 3 0 0");
}

TEST(GcodeFlow, BreakDoesNotEndTheNextLoop) {
  // LinuxCNC does not clear the break and leaves the next do loop after one pass.
  EXPECT_EQ(
      moves_of("o1 while [1]\no1 break\no1 endwhile\n#1=0\no2 do\n#1=[#1+1]\nG0 X#1\no2 while "
               "[#1 lt 3]\nM2\n"),
      "R 1 0 0, R 2 0 0, R 3 0 0");
}

TEST(GcodeFlow, ExactlyOneBranchIsExecuted) {
  const std::string branches =
      "o1 if [#1 eq 1]\nG0 X1\no1 elseif [#1 eq 2]\nG0 X2\no1 elseif [#1 eq 2]\nG0 X9\no1 else\n"
      "G0 X3\no1 endif\nM2\n";
  EXPECT_EQ(moves_of("#1=1\n" + branches), "R 1 0 0");
  EXPECT_EQ(moves_of("#1=2\n" + branches), "R 2 0 0");
  EXPECT_EQ(moves_of("#1=5\n" + branches), "R 3 0 0");
  EXPECT_EQ(moves_of("o1 if [0]\nG0 nonsense ((\no1 endif\nG0 X1\nM2\n"), "R 1 0 0");
}

TEST(GcodeFlow, SubroutinesHaveLocalArgumentsAndNames) {
  EXPECT_EQ(
      moves_of("#1=7 #2=8\n#<a>=1 #<_g>=2\no<s> sub\n#<a>=5\n#<_g>=6\nG0 X#1 Y#2 Z#3\n#1=99\no<s> "
               "endsub [#1]\no<s> call [1] [2]\nG0 X#1 Y#<a> Z#<_g>\nG0 X#<_value> "
               "Y#<_value_returned>\nM2\n"),
      "R 1 2 0, R 7 1 6, R 99 1 6");
  EXPECT_EQ(moves_of("o1 sub\no2 if [#1 le 1]\no1 return [1]\no2 endif\n#2=#1\no1 call [#1-1]\no1 "
                     "endsub [#<_value>*#2]\no1 call [5]\nG0 X#<_value>\nM2\n"),
            "R 120 0 0");
}

TEST(GcodeFlow, SubroutineMayFollowItsCall) {
  EXPECT_EQ(moves_of("o<late> call [4]\nG0 Y1\nM2\no<late> sub\nG0 X#1\no<late> endsub\n"),
            "R 4 0 0, R 4 1 0");
}

TEST(GcodeFlow, FanucSubprogramsShareParameters) {
  EXPECT_EQ(
      moves_of(
          "#1=3\nG91\nM98 P100 L2\nG90 G0 Y#1\nM98 P100 L0\nM2\nO100\nG0 X#1\n#1=[#1+1]\nM99\n"),
      "R 3 0 0, R 7 0 0, R 7 5 0");
}

TEST(GcodeFlow, SavedModesBelongToTheSubroutine) {
  EXPECT_EQ(moves_of("G21 G90 F100\nM70\nG91 G20\nG0 X1\nM72\nG0 X1\nM2\n"), "R 25.4 0 0, R 1 0 0");
  EXPECT_EQ(moves_of("o1 sub\nM73\nG91\nG0 X1\no1 endsub\nG0 X5\no1 call\nG0 X2\nM2\n"),
            "R 5 0 0, R 6 0 0, R 2 0 0");
}

struct Bad {
  const char* text;
  std::size_t line;
  const char* word;
  const char* reason;
};
class BadFlow : public testing::TestWithParam<Bad> {};

TEST_P(BadFlow, IsRejectedWithLineAndWord) {
  const ProgramError error = run_error_of(GetParam().text);
  EXPECT_EQ(error.line, GetParam().line) << error.reason;
  EXPECT_EQ(error.word, GetParam().word) << error.reason;
  EXPECT_THAT(error.reason, HasSubstr(GetParam().reason));
}

INSTANTIATE_TEST_SUITE_P(
    GcodeFlow, BadFlow,
    testing::Values(Bad{"o1 while [1]\n#1=2\no1 endwhile\nM2\n", 2, "#1=2", "does not end"},
                    Bad{"o1 do\no1 while [1]\n", 2, "o1 while [1]", "does not end"},
                    Bad{"o1 sub\no1 call\no1 endsub\no1 call\nM2\n", 2, "O1 CALL",
                        "nested deeper than 9"},
                    Bad{"o1 if [0]\nM2\n", 1, "O<1>", "without endif"},
                    Bad{"o1 while [0]\nM2\n", 1, "O<1>", "without endwhile"},
                    Bad{"o1 endwhile\n", 1, "O1 ENDWHILE", "no matching start"},
                    Bad{"o1 else\n", 1, "O1 ELSE", "no matching start"},
                    Bad{"o1 repeat [1]\no1 break\n", 2, "O1 BREAK", "no matching while"},
                    Bad{"o1 if [1]\no1 endif\no1 if [1]\n", 3, "O1 IF", "already used in line 1"},
                    Bad{"o1 endsub\n", 1, "O1 ENDSUB", "within a subroutine only"},
                    Bad{"o1 sub\nG0 X1\n", 1, "O<1>", "endsub"},
                    Bad{"o1 sub\no1 endsub\no1 sub\n", 3, "O1 SUB", "already defined"},
                    Bad{"o<../x> call\n", 1, "O<../x>", "not allowed as the name"},
                    Bad{"o1 foo\n", 1, "O1", "control flow"},
                    Bad{"o1 if\n", 1, "O1 IF", "value in brackets"},
                    Bad{"o1 if [1] G0\n", 1, "O1 IF", "must not be followed"},
                    Bad{"o[1/0] call\n", 1, "/0", "finite"}, Bad{"M98\n", 1, "M98", "requires P"},
                    Bad{"M72\n", 1, "M72", "requires modes saved"},
                    Bad{"(abort, no)\n", 1, "(abort, no)", "abort"},
                    Bad{"G0 X#<_hal[a.b]>\n", 1, "#<_hal[a.b]>", "configuration"},
                    Bad{"#<_x>=1\n", 1, "#<_x>", "read-only"}),
    [](const auto& name) { return "Case" + std::to_string(name.index); });

// Without subroutine folders the reader opens no file.
TEST(GcodeFlow, SubroutineFilesAreReadFromTheGivenFoldersOnly) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "kerf_gcode_flow_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "slot.ngc") << "(a slot)\no<slot> sub\nG0 X#1\no<slot> endsub\n";
  std::ofstream(folder / "broken.ngc") << "\no<broken> sub\nG1 X1\no<broken> endsub\n";
  const std::string program = "G0 Y1\nO<Slot> call [5]\nG0 Y2\nM2\n";
  GcodeEnvironment environment;
  EXPECT_THAT(run_error_of(program, environment).reason, HasSubstr("neither in the program"));
  environment.subroutine_folders = {folder / "nowhere", folder};
  EXPECT_EQ(moves_of(program, environment), "R 0 1 0, R 5 1 0, R 5 2 0");
  const ProgramError error = run_error_of("o<broken> call\nM2\n", environment);
  EXPECT_EQ(error.file, (folder / "broken.ngc").string());
  EXPECT_EQ(error.line, 3u);
  const Scene scene = test::scene_for("xyz");
  const auto read = test::value_of(parse_program(
      "p.ngc", "T1 M6 F100\nG0 X0 Y0 Z0\no<slot> call [5]\nM2\n", scene, environment));
  const ProgramMotion& motion = read.motions.back();
  EXPECT_EQ(place_of(read, motion.file, motion.line), (folder / "slot.ngc").string() + ":3");
  std::filesystem::remove_all(folder);
}

TEST(GcodeFlow, NumberOfNamesIsLimited) {
  std::string text;
  for (std::size_t i = 0; i <= kGcodeNamesMax; ++i) text += "#<n" + std::to_string(i) + ">=1\n";
  const ProgramError error = run_error_of(text);
  EXPECT_EQ(error.line, kGcodeNamesMax + 1);
  EXPECT_THAT(error.reason, HasSubstr("in one scope"));
}

}  // namespace
}  // namespace kerf::gcode_flow_test
