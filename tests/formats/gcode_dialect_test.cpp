// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/dialect_choice.h"
#include "server/formats/gcode/source.h"
#include "tests/formats/dialect_runs.h"
#include "tests/support/test.h"

namespace kerf::gcode_dialect_test {
namespace {

using test::as;
using test::fanuc;
using test::haas;
using test::refused;
using testing::Contains;
using testing::HasSubstr;

Dialect judged(const std::string& text, const std::string& name = "p.nc") {
  const auto choice = choose_dialect(name, text);
  EXPECT_TRUE(choice.has_value()) << to_string(choice.error());
  return choice ? choice->dialect : Dialect::kAuto;
}

TEST(DialectChoice, CommentsAfterASemicolonAreNoCode) {
  for (const char* comment :
       {"; 9mm, cut-through", "; corner ,R2", "; G65 P1", "; #<width>", "; o<main> sub"}) {
    EXPECT_TRUE(choose_dialect("p.nc", std::string("G21 G90 ") + comment + "\nG0 X1\n")->open)
        << comment;
  }
  EXPECT_FALSE(choose_dialect("p.nc", "G1 X1 ,C2; a corner\n")->open);
}

TEST(DialectChoice, IsDeterminedByWordsOfOneController) {
  EXPECT_EQ(judged("%\nO1000\nG0 X1\nM30\n"), Dialect::kFanuc);
  EXPECT_EQ(judged("%\nO1000\nG154 P2\nM30\n"), Dialect::kHaas);
  EXPECT_EQ(judged("%\nO1000\n(HAAS VF2)\nM30\n"), Dialect::kHaas);
  EXPECT_EQ(judged("o100 sub\no100 endsub\n#<a>=1\nM2\n"), Dialect::kLinuxcnc);
  EXPECT_EQ(judged("G0 X1\nIF[#1EQ2]GOTO3\n"), Dialect::kFanuc);
  EXPECT_EQ(judged("(made for Mach3)\nG0 X1\n"), Dialect::kMach3);
  EXPECT_EQ(judged("(Mach3 job)\nG12 I5\nG16\nG0 X1 Y45\nG15\nO50\nM99\n"), Dialect::kMach3);
  EXPECT_EQ(judged("(from Mach3)\nO50\nG154 P2\nM97 P3\n"), Dialect::kHaas);
  EXPECT_EQ(judged("$H\nG0 X1\n"), Dialect::kGrbl);
  EXPECT_TRUE(choose_dialect("p.nc", "G0 X1\n")->open);
  EXPECT_FALSE(choose_dialect("p.ngc", "G0 X1\n")->open);
  EXPECT_THAT(choose_dialect("p.nc", "G0 X1\nG154 P1\n")->reason, HasSubstr("line 2 has G154"));
}

TEST(DialectChoice, KlartextWithoutItsReaderIsNamed) {
  const auto error =
      test::error_of(choose_dialect("p.h", "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S1000\n"));
  EXPECT_THAT(to_string(error), HasSubstr("HEIDENHAIN Klartext (line 1 has BEGIN PGM)"));
}

TEST(DialectChoice, CommentsAndProgramNamesDoNotCount) {
  EXPECT_EQ(judged("%\nO1000 (CUSTOMER MCALLISTER)\nG0 X1\n"), Dialect::kFanuc);
  EXPECT_EQ(judged("%\nO1000\n(MCALL AND SINUMERIK)\nG0 X1\n"), Dialect::kFanuc);
  EXPECT_EQ(judged("%\nO1000\n(STEP RATIO<5 PERCENT)\nG0 X1\n"), Dialect::kFanuc);
  EXPECT_EQ(judged("%\nO1000\n(HAASE GMBH)\nG0 X1\n"), Dialect::kFanuc);
  EXPECT_EQ(judged("%\nO1000 DOVETAIL\nG0 X1\n"), Dialect::kFanuc);
  EXPECT_EQ(judged("%\nO1000 SUPA PART\nG0 X1\n"), Dialect::kFanuc);
  EXPECT_EQ(judged("o100 do\no100 while [#1 LT 2]\n"), Dialect::kLinuxcnc);
  EXPECT_EQ(judged("N10 MCALL CYCLE81(1,2)\n"), Dialect::kSiemens);
  EXPECT_EQ(judged(";$PATH=/_N_MPF\nG0 X1\n"), Dialect::kSiemens);
  EXPECT_EQ(judged("MSG(\"A\")\nG0 X1\n"), Dialect::kSiemens);
  EXPECT_EQ(judged("TRAORI\nG0 X1\n"), Dialect::kSiemens);
}

TEST(DialectChoice, ProgramRejectedByLinuxcncDefaultsToFanuc) {
  const Scene scene = test::scene_for("xyz");
  const std::string text = "G21 G90 T1 M6\nG0 X0 Y0 Z5\nG1 Z-1 F100 M131\nM30\n";
  const auto program = test::value_of(parse_program("p.nc", text, scene));
  EXPECT_THAT(program.warnings, Contains(HasSubstr("read as Fanuc")));
  EXPECT_THAT(program.warnings, Contains(HasSubstr("M131 is taken as a code that moves nothing")));
  const auto error = test::error_of(parse_program("p.ngc", text, scene));
  EXPECT_THAT(to_string(error), HasSubstr("(read as LinuxCNC)"));
}

TEST(LinuxcncBlock, HasOneCodeOfAGroupAndClosedComments) {
  const auto error = [](const std::string& text) { return refused(text, Dialect::kLinuxcnc); };
  EXPECT_THAT(error("X1\nM2\n"), HasSubstr("motion code")) << "starts in G80";
  EXPECT_EQ(test::moves_of("F100\nG0 X0 Y0 Z10\nG81 X1 Z-5 R3\nM2\n"),
            "R 0 0 10, R 1 0 10, R 1 0 3, F 1 0 -5, R 1 0 3")
      << "starts in G99";
  EXPECT_THAT(error("G90 G91 G0 X1\n"), HasSubstr("conflicts with G90"));
  EXPECT_THAT(error("G0 X1 (a (nested) one)\n"), HasSubstr("must not contain another comment"));
  EXPECT_THAT(error("G0 X1 (open\n"), HasSubstr("not closed"));
  EXPECT_EQ(test::moves_of("G4 P1\nM2\n"), "D 1");
  EXPECT_THAT(error("M80\n"), HasSubstr("is not a supported code"));
}

TEST(MacroFlow, SubprogramsRepeatAndReturn) {
  EXPECT_EQ(fanuc("%\nO1\nG91\nM98 P2 L2\nG0 Y1\nM30\nO2 (SUB)\nG0 X1\nM99\n%\n"),
            "R 1 0 0, R 2 0 0, R 2 1 0");
  EXPECT_EQ(fanuc("O1\nG91\nM98 P30002\nM30\nO2\nG0 X1\nM99\n"), "R 1 0 0, R 2 0 0, R 3 0 0");
  EXPECT_EQ(fanuc(":0001\nG91 G0 X5 M98 P7\nM30\n:0007\nG0 X1\nM99\n"), "R 5 0 0, R 6 0 0");
  EXPECT_EQ(haas("O1\nG91\nM97 P50 L2\nM30\nN50 G0 X1\nM99\n"), "R 1 0 0, R 2 0 0");
  EXPECT_EQ(fanuc("O1\nM98 P2\nG0 X9\nN30 G0 X1\nM30\nO2\nG0 Y1\nM99 P30\n"), "R 0 1 0, R 1 1 0");
  EXPECT_EQ(fanuc("%\nG0 Z4\nO1\nG0 X1\nM30\nO2\nG0 X9\n"), "R 0 0 4, R 1 0 4");
  EXPECT_THAT(refused("O1\nM98 P5\nM30\n"), HasSubstr("calls O5"));
  EXPECT_THAT(refused("O1\nM98 P1\nM30\n"), HasSubstr("nested deeper"));
  EXPECT_THAT(refused("O1\nM98 P2\nM30\nO2\nG0 X1\nO3\n"), HasSubstr("ends without M99"));
}

TEST(MacroFlow, BranchesAndLoops) {
  EXPECT_EQ(fanuc("#1=0\nN10 #1=#1+1\nG0 X#1\nIF[#1LT3]GOTO10\nM30\n"),
            "R 1 0 0, R 2 0 0, R 3 0 0");
  EXPECT_EQ(fanuc("#1=0\nWHILE [#1 LT 2] DO1\n#1=#1+1\n#2=0\nWHILE[#2LT1]DO2\n#2=#2+1\nG0 X#1 "
                  "Y#2\nEND2\nEND1\nM30\n"),
            "R 1 1 0, R 2 1 0");
  EXPECT_EQ(fanuc("#1=5\nIF [#1 GT 4] THEN #2=7\nIF[#1GT9]THEN #2=8\nG0 X#2\nGOTO 5\nG0 X99\nN5 G0 "
                  "Y1\nM30\n"),
            "R 7 0 0, R 7 1 0");
  EXPECT_EQ(fanuc("GOTO 3\nG0 X1\nN2 M30\nN3 G0 X2\nGOTO 2\n"), "R 2 0 0");
  EXPECT_THAT(refused("GOTO 3\nM30\n"), HasSubstr("N3"));
  EXPECT_THAT(refused("N1 GOTO 1\n"), HasSubstr("does not end"));
  EXPECT_THAT(refused("WHILE[1EQ1]DO1\nM30\n"), HasSubstr("no matching END"));
  EXPECT_THAT(refused("IF[1EQ1]\nM30\n"), testing::EndsWith("(read as Fanuc)"));
}

TEST(MacroIndex, FindsALineWithFewComparisons) {
  std::string text = "O1\nN1 DO1\nEND1\n";
  for (int i = 0; i < 50'000; ++i) text += "N9\n";
  text += "O2\nN1\nDO1\nDO1\nEND1\nEND1\nN1\nO2\nN3\n";
  const GcodeFile file("p", text);
  const MacroIndex& index = file.marks();
  const std::size_t second = 50'003;
  EXPECT_EQ(index.program(2), second);
  EXPECT_EQ(index.program(3), std::nullopt);
  EXPECT_EQ(index.sequence(1, 40'000), 1u);
  EXPECT_EQ(index.sequence(9, 20'000), 20'001u);
  EXPECT_EQ(index.sequence(1, second), second + 1);
  EXPECT_EQ(index.sequence(1, second + 1), second + 6);
  EXPECT_EQ(index.sequence(1, second + 6), second + 1);
  EXPECT_EQ(index.sequence(3, second), std::nullopt);
  EXPECT_EQ(index.end_of(1, second + 4), second + 5);
  EXPECT_EQ(index.end_of(1, second + 5), std::nullopt);
  EXPECT_EQ(index.start_of(1, second + 4), second + 3);
  EXPECT_EQ(index.start_of(1, second + 2), std::nullopt);
  EXPECT_LT(index.comparisons(), 12u * 2 * 20);
}

TEST(MacroFlow, MacroCallsHaveArgumentsAndVacantVariables) {
  EXPECT_EQ(fanuc("O1\nG65 P9010 X1 Y2 I3\nM30\nO9010\nG0 X#24 Y#25 Z#4\nIF[#1EQ#0]GOTO5\nG0 "
                  "X99\nN5 M99\n"),
            "R 1 2 3");
  // A vacant variable removes its word and counts as 0 in a sum, but does not equal 0.
  EXPECT_EQ(fanuc("G0 X5\nG0 X#1 Y1\nG0 X[#1+2]\nIF[#1EQ0]GOTO9\nG0 Z1\nN9 M30\n"),
            "R 5 0 0, R 5 1 0, R 2 1 0, R 2 1 1");
  EXPECT_EQ(fanuc("O1\nG66 P2 A1\nG90 G0 X1\nX2\nG67\nX3\nM30\nO2\nG91 G0 Y#1\nG90\nM99\n"),
            "R 1 0 0, R 1 1 0, R 2 1 0, R 2 2 0, R 3 2 0");
  EXPECT_EQ(fanuc("#1=#4003\nG91\nG#1 G0 X1\nX1.\n#2=#5001\nG0 Y#2\nM30\n"),
            "R 1 0 0, R 1 0 0, R 1 1 0");
  EXPECT_EQ(fanuc("O1\nG65 P2 I1 J2 K3 I4 J5 K6 I7\nM30\nO2\nG0 X#4 Y#5 Z#6\nX#7 Y#8 Z#9\n"
                  "X#10 Y0 Z0\nM99\n"),
            "R 1 2 3, R 4 5 6, R 7 0 0");
  EXPECT_EQ(fanuc("O1\nG65 P2 I1 I2 E5 J9\nM30\nO2\nG0 X#7 Y#8\nM99\n"), "R 2 9 0");
  EXPECT_THAT(refused("O1\nG65 P2 J1 I2\nM30\nO2\nM99\n"), HasSubstr("out of order"));
  EXPECT_THAT(refused("#3000=1(NO TOOL)\n"), HasSubstr("raises an alarm"));
  EXPECT_THAT(refused("G0 X#2001\n"), HasSubstr("system variable"));
}

TEST(MacroExpression, HasThePrecedenceAndRoundingOfMacroB) {
  EXPECT_EQ(fanuc("#1=2+3*4\n#2=#1-10\nG0 X#1 Y#2\nM30\n"), "R 14 4 0");
  EXPECT_EQ(fanuc("G0 X[2+3*4] Y[FIX[-1.5]] Z[FUP[-1.5]]\nM30\n"), "R 14 -1 -2");
  EXPECT_EQ(fanuc("G0 X[6 AND 3] Y[4 OR 1] Z[ATAN[1]/[1]]\nX[ATAN[1,1]]\nM30\n"),
            "R 2 5 45, R 45 5 45");
}

}  // namespace
}  // namespace kerf::gcode_dialect_test
