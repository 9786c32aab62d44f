// SPDX-License-Identifier: Apache-2.0
#include "server/formats/control/fault.h"
#include "server/formats/gcode/block.h"
#include "server/formats/gcode/expression.h"
#include "tests/support/test.h"

namespace kerf::gcode_expression_test {
namespace {

GcodeBlock block_of(const std::string& line, GcodeParameters& parameters) {
  return parse_gcode_block(split_gcode_line(line).code, parameters);
}

// Returns the value of the word in a line such as "x[1+2]".
double value_of(const std::string& text, const std::string& before = "") {
  GcodeParameters parameters;
  if (!before.empty()) block_of(before, parameters);
  return block_of("x" + text, parameters).find('x')->value;
}

ProgramFault fault_of(const std::string& line) {
  GcodeParameters parameters;
  try {
    block_of(line, parameters);
  } catch (const ProgramFault& fault) {
    return fault;
  }
  ADD_FAILURE() << line << " was accepted";
  return {};
}

struct Case {
  const char* text;
  double value;
};

class Expressions : public testing::TestWithParam<Case> {};

TEST_P(Expressions, EvaluateAsInLinuxCnc) {
  EXPECT_NEAR(value_of(GetParam().text, "#1=3 #2=5 #5=1 #<a>=7 #<_G b>=11"), GetParam().value,
              1e-12)
      << GetParam().text;
}

INSTANTIATE_TEST_SUITE_P(
    GcodeExpression, Expressions,
    testing::Values(Case{"1", 1}, Case{"-1.5", -1.5}, Case{"+.5", .5}, Case{"5.", 5},
                    Case{"- -3", 3}, Case{"-[3]", -3}, Case{"[1+2*3**2]", 19},
                    Case{"[2**3**2]", 64}, Case{"[-2**2]", 4}, Case{"[3 - 2 ** 2]", -1},
                    Case{"[2-3-4]", -5}, Case{"[8/4/2]", 1}, Case{"[5 mod -3]", 2},
                    Case{"[-5 mod 3]", 1}, Case{"[2*-3]", -6}, Case{"[1 - -2]", 3},
                    Case{"[[1+2]*[3+4]]", 21}, Case{"[1 or 0 and 0]", 0}, Case{"[0 xor 1 or 1]", 1},
                    Case{"[1 xor 1]", 0}, Case{"[1 lt 2 eq 1]", 1}, Case{"[1 eq 0 + 1]", 1},
                    Case{"[2 eq 2.00005]", 1}, Case{"[2 ne 2.00005]", 0}, Case{"[2 gt 1]", 1},
                    Case{"[2 ge 2]", 1}, Case{"[2 le 1]", 0}, Case{"[2 lt 1]", 0},
                    Case{"abs[-2]", 2}, Case{"acos[0]", 90}, Case{"asin[1]", 90},
                    Case{"atan[1]/[0]", 90}, Case{"atan[-1]/[-1]", -135}, Case{"cos[60]", 0.5},
                    Case{"exp[1]", 2.718281828459045}, Case{"fix[-2.8]", -3}, Case{"fup[2.1]", 3},
                    Case{"ln[exp[2]]", 2}, Case{"round[-2.5]", -3}, Case{"round[2.5]", 3},
                    Case{"sin[30]", 0.5}, Case{"sqrt[9]", 3}, Case{"tan[45]", 1}, Case{"#1", 3},
                    Case{"-#1", -3}, Case{"##5", 3}, Case{"#[#2+1]", 0}, Case{"#[1+1]", 5},
                    Case{"#<a>", 7}, Case{"#< A >", 7}, Case{"#<_gb>", 11}, Case{"[#<a>*10.]", 70},
                    Case{"exists[#<a>]", 1}, Case{"exists[#<nothing>]", 0}, Case{"exists[#9]", 1},
                    Case{"SQRT[ 4 ]", 2}, Case{"1 2 . 5", 12.5}));

TEST(GcodeExpression, InvalidExpressionsAreRejected) {
  EXPECT_THAT(fault_of("x[1/0]").reason, testing::HasSubstr("finite"));
  EXPECT_EQ(fault_of("xsqrt[-1]").word, "XSQRT[-1]");
  for (const char* line :
       {"xacos[2]",   "xln[0]",     "x[5 mod 0]", "x[-8**0.5]", "x[10**400]", "x[1+]",   "x[1",
        "x1]",        "x1+2",       "x",          "x.",         "x-",         "xfoo[1]", "xatan[1]",
        "xatan[1]/2", "x#",         "x#0",        "x#6000",     "x#1.5",      "x#<a",    "x#<>",
        "x#<b>",      "xexists[1]", "x1.5.2",     "x[1 foo 2]", "x[]"})
    fault_of(line);
  fault_of("x" + std::string(5000, '['));
  fault_of("x" + std::string(5000, '-') + "1");
  fault_of("x" + std::string(5000, '#') + "1");
}

TEST(GcodeExpression, ErrorsNameTheWholeWord) {
  EXPECT_EQ(fault_of("g1 if[#1lt#2]goto1").word, "IF[#1LT#2]GOTO1");
  EXPECT_EQ(fault_of("g1 x").word, "X");
  EXPECT_EQ(fault_of("y[1/0]").word, "Y[1/0");
  EXPECT_EQ(fault_of("#1=foo[1]").word, "#1=FOO[1]");
}

TEST(GcodeParameters, AssignmentsTakeEffectOnTheNextLine) {
  GcodeParameters parameters;
  block_of("#3=6", parameters);
  EXPECT_EQ(block_of("#3=15 x#3 #4=#3", parameters).find('x')->value, 6);
  EXPECT_EQ(parameters.numbered(3), 15);
  EXPECT_EQ(parameters.numbered(4), 6);
  block_of("#3=1 #3=2", parameters);
  EXPECT_EQ(parameters.numbered(3), 2);
}

TEST(GcodeParameters, PositionAndToolCannotBeAssigned) {
  EXPECT_EQ(fault_of("#5400=1").word, "#5400");
  EXPECT_EQ(fault_of("#5420=1").word, "#5420");
  fault_of("#1");
  fault_of("#<a>");
}

TEST(GcodeBlock, LowerCaseAndBlanksAreAccepted) {
  GcodeParameters parameters;
  GcodeBlock block = block_of("n 1 0 g 0 1 x +0. 1 2 34 y 7 (a comment) z1;and x9", parameters);
  EXPECT_EQ(block.find('x')->value, 0.1234);
  EXPECT_EQ(block.find('y')->value, 7);
  EXPECT_EQ(block.find('z')->value, 1);
  EXPECT_EQ(block.code(GcodeGroup::kMotion)->code, 10);
  EXPECT_EQ(block.code(GcodeGroup::kMotion)->text, "G01");
}

TEST(GcodeBlock, CommentsAreRemoved) {
  EXPECT_EQ(split_gcode_line("G1 (MSG, X5 ; not a comment) X1 ; (open").code, "g1x1");
  EXPECT_THROW(split_gcode_line("G1 (open"), ProgramFault);
  EXPECT_THROW(split_gcode_line("G1 (a (b) c)"), ProgramFault);
  EXPECT_THROW(split_gcode_line("G1 )"), ProgramFault);
}

TEST(GcodeBlock, ConflictingAndInvalidWordsAreRejected) {
  EXPECT_EQ(fault_of("G0 G1 X1").word, "G1");
  EXPECT_THAT(fault_of("G0 G1 X1").reason, testing::HasSubstr("modal group"));
  EXPECT_EQ(fault_of("G90 X1 G91").word, "G91");
  EXPECT_EQ(fault_of("M3 M5").word, "M5");
  EXPECT_EQ(fault_of("X1 X2").word, "X2");
  EXPECT_EQ(fault_of("G1 N5").word, "n");
  EXPECT_EQ(fault_of("G5.2").word, "G5.2");
  EXPECT_EQ(fault_of("G1.55").word, "G1.55");
  EXPECT_EQ(fault_of("G-1").word, "G-1");
  EXPECT_EQ(fault_of("M200").word, "M200");
  EXPECT_EQ(fault_of("O100 sub").word, "o");
  EXPECT_EQ(fault_of("U1").word, "u");
  EXPECT_EQ(fault_of("G1 X1 &").word, "&");
  EXPECT_EQ(fault_of("N").reason, "requires a line number");
  EXPECT_EQ(fault_of(std::string("X1\0", 3)).word, std::string(1, '\0'));
  EXPECT_EQ(fault_of("X1\xff").word, "\xff");
}

TEST(GcodeBlock, BlockDeleteIsAllowedAtTheBeginningOnly) {
  EXPECT_EQ(fault_of("G1 / X1").word, "/");
}

}  // namespace
}  // namespace kerf::gcode_expression_test
