// SPDX-License-Identifier: Apache-2.0
// Which rapids of a verified program cut into the stock.
#include "tests/formats/verify_fixture.h"
#include "tests/support/test.h"

namespace kerf::verify_rapids_test {
namespace {

using test::add_facet;
using test::Corner;
using test::kSlotted;
using test::Verify;
using testing::StartsWith;

/// A disc of 40 mm: its box has corners where a round blank has no material.
std::string disc() {
  std::string stl = "solid d\n";
  const auto at = [](int n, double z) {
    return Corner{20 + 20 * std::cos(n * M_PI / 16), 20 + 20 * std::sin(n * M_PI / 16), z};
  };
  for (int n = 0; n < 32; ++n) {
    add_facet(stl, {20, 20, 0}, at(n, 0), at(n + 1, 0));
    add_facet(stl, {20, 20, -10}, at(n + 1, -10), at(n, -10));
    add_facet(stl, at(n, -10), at(n + 1, -10), at(n, 0));
    add_facet(stl, at(n, 0), at(n + 1, -10), at(n + 1, 0));
  }
  return stl + "endsolid d\n";
}

TEST_F(Verify, ARapidThroughStockIsNamedWithItsLine) {
  write_program("G0 Z-2\nG1 Y10\nG0 Y36\n");
  const auto checks = failed(kSlotted, 3);
  ASSERT_EQ(checks.size(), 1U) << content("out");
  EXPECT_EQ(checks.at("rapids through stock")["worst"][0]["place"], "p.ngc:6");
  EXPECT_THAT(content("out"), StartsWith("p.ngc makes part.stl within 0.1 mm, but not safely: "));
}

TEST_F(Verify, RapidThatRemovesAFilmIsNotThroughStock) {
  // Back along the floor of the slot, deeper by less than the tolerance of the cuts, 0.025 mm.
  write_program("G0 Z-2\nG1 Y36\nG0 Z-2.001\nY-6\n");
  EXPECT_THAT(failed(kSlotted, 0), testing::IsEmpty()) << content("out");
  write_program("G0 Z-2\nG1 Y36\nG0 Z-2.02\nY-6\n");
  EXPECT_THAT(failed(kSlotted, 0), testing::IsEmpty()) << content("out");
  write_program("G0 Z-2\nG1 Y36\nG0 Z-2.03\nY-6\n");
  EXPECT_EQ(failed(kSlotted, 3).count("rapids through stock"), 1U);
}

// The tool removes a tenth of a cubic millimeter of an edge, 0.25 mm deep.
TEST_F(Verify, ASmallDeepCutOfARapidIsThroughStock) {
  write_program("G0 Z-2\nG1 Y36\nG0 Z5\nX-2.4 Y-2.4\nZ-0.3\nZ5\n");
  const auto checks = failed(kSlotted + "--tolerance 0.5", 3);
  ASSERT_EQ(checks.count("rapids through stock"), 1U) << content("out");
  EXPECT_THAT(std::string(checks.at("rapids through stock")["worst"][0]["what"]),
              testing::HasSubstr("mm deep, "));
}

TEST_F(Verify, OfAnAssumedStockOnlyTheMaterialAboveThePartMeetsRapids) {
  write("part.stl", disc());
  const auto rapids = [this](const std::string& at, const std::string& stock) {
    write("p.ngc", "G21 G90 T1 M6\nG0 " + at +
                       " Z5\nG0 Z-5\nG1 Z-6 F600\nG0 Z5\nX20 Y20\nG1 Z-1\nG0 Z5\nM2\n");
    const auto checks = failed(
        "--verify p.ngc --reference part.stl --tool 1=6 --pitch 0.5 --wall-samples 0" + stock, 3);
    return checks.count("rapids through stock");
  };
  EXPECT_EQ(rapids("X2 Y2", ""), 0U) << "a corner of the box";
  EXPECT_EQ(rapids("X20 Y30", ""), 1U);
  EXPECT_EQ(rapids("X2 Y2", " --stock 40,40,10"), 1U) << "a stated stock";
}

}  // namespace
}  // namespace kerf::verify_rapids_test
