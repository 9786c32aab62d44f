// SPDX-License-Identifier: Apache-2.0
// Work offsets that programs of Fanuc and Haas set, without a parameter file.
#include "server/formats/number_text.h"
#include "tests/formats/dialect_runs.h"
#include "tests/support/test.h"

namespace kerf::gcode_offsets_test {
namespace {

using test::as;
using testing::Contains;
using testing::HasSubstr;

// The first feed of a program that is read without a parameter file, and its warnings.
struct FirstCut {
  std::string at;
  std::vector<std::string> warnings;
};

FirstCut first_cut(const std::string& text, Dialect dialect = Dialect::kFanuc) {
  const auto program = parse_program("p.nc", "G21 G17 G90\nT1 M6\n" + text + "G0 Z9.\nM30\n",
                                     test::scene_for("xyz"), as(dialect));
  EXPECT_TRUE(program) << to_string(program.error()) << text;
  if (!program) return {};
  for (const ProgramMotion& motion : program->motions)
    if (!motion.rapid) {
      const Vec3& tip = motion.to.tip_mm;
      return {decimal_text(tip.x, 3) + " " + decimal_text(tip.y, 3) + " " + decimal_text(tip.z, 3),
              program->warnings};
    }
  return {};
}

TEST(FanucOffsets, G54OffsetsAreTheScenesZero) {
  const std::string cut = "G0 X0 Y0 Z5.\nG1 X1. Y2. Z-3. F99\n";
  const std::string set = "G10 L2 P1 X-269.39 Y-254.65 Z-389.\n";
  for (const Dialect dialect : {Dialect::kFanuc, Dialect::kHaas}) {
    EXPECT_EQ(first_cut(set + "G54 " + cut, dialect).at, "1 2 -3");
    EXPECT_EQ(first_cut("#5221=-269.39 #5222=-254.65 #5223=-389.\nG54 " + cut, dialect).at,
              "1 2 -3");
    EXPECT_EQ(first_cut("G91 G28 Z0\nG90 G53 G0 Z0\n" + set + "G54 " + cut, dialect).at, "1 2 -3");
  }
  EXPECT_THAT(first_cut(set + cut).warnings, Contains(HasSubstr("machine coordinates")));
  EXPECT_EQ(first_cut("G10 L2 P1 X7.\n" + cut, Dialect::kMach3).at, "8 2 -3")
      << "a control without a shop's offsets";
}

TEST(FanucOffsets, CountByTheirDifferences) {
  const std::string cut = "G0 X0 Y0 Z5.\nG1 X1. Y2. Z-3. F99\n";
  const std::string both = "G10 L2 P1 X-300. Y-200. Z-400.\nG10 L2 P2 X-260. Y-200. Z-390.\n";
  EXPECT_EQ(first_cut(both + "G55 " + cut).at, "41 2 7");
  EXPECT_EQ(first_cut(both + "G54 " + cut).at, "1 2 -3");
  EXPECT_EQ(first_cut("G10 L2 P2 X-260. Y-200.\nG55 " + cut).at, "1 2 -3") << "the only one";
  EXPECT_EQ(first_cut("G10 L2 P1 X0 Y0 Z-400.\nG10 L2 P2 X50. Y0 Z-400.\nG55 " + cut).at, "51 2 -3")
      << "0 is an offset, too";
  const std::string move = "G0 X0 Y0 Z5.\n";
  EXPECT_EQ(first_cut("G10 L2 P1 X-300.\n" + move + "G10 L2 P1 X-290.\nG1 X1. Y0 Z0 F9\n").at,
            "11 0 0");
  EXPECT_EQ(first_cut(move + "#5221=#5221+50.\nG1 X1. Y0 Z0 F9\n").at, "51 0 0");
  EXPECT_EQ(first_cut("G91 G10 L2 P1 X5.\nG90 " + move + "G1 X1. Y0 Z0 F9\n").at, "6 0 0");
  EXPECT_EQ(first_cut("G10 L2 P1 X-300.\nG68 X0 Y0 R90.\n" + move + "G1 X0 Y-1. Z0 F9\n").at,
            "1 0 0");
}

}  // namespace
}  // namespace kerf::gcode_offsets_test
