// SPDX-License-Identifier: Apache-2.0
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::undercut_test {
namespace {

const Vec3 kUp{0, 0, 1};

/// A block that is large enough for a slot along x; its rays run along Z.
Sculpture block() {
  return *Sculpture::create({.stock = BoxStock{{0, -20, -20}, {60, 20, 0}}, .pitch_mm = 0.1});
}

/// Moves a tool through the whole block along x, its tip 15 mm below the top.
double slot_mm3(const ToolShape& shape) {
  Sculpture s = block();
  s.apply(DefineTool{1, *make_tool(shape)}).value();
  return s.apply(MoveTool{1, {{-20, 0, -15}, kUp}, {{80, 0, -15}, kUp}, 1}).value().removed_mm3;
}

TEST(Undercut, TSlotRemovesExactlyHeadAndNeck) {
  const double removed =
      slot_mm3(ProfileShape{{ProfilePoint{0, 0}, ProfilePoint{10, 0}, ProfilePoint{10, 6},
                             ProfilePoint{4, 6}, ProfilePoint{4, 40}}});
  EXPECT_NEAR(removed, 60 * (20 * 6 + 8 * 9), 0.01 * removed);
}

TEST(Undercut, DovetailLeavesTheMaterialAboveItsFlanks) {
  const double removed =
      slot_mm3(ProfileShape{{ProfilePoint{10, 0}, ProfilePoint{5, 8}, ProfilePoint{5, 40}}});
  EXPECT_NEAR(removed, 60 * (15 * 8 + 10 * 7), 0.01 * removed);
}

TEST(Undercut, OppositeDirectionsRemoveTheSame) {
  const Tool tool =
      *make_tool(ProfileShape{{ProfilePoint{10, 0}, ProfilePoint{5, 8}, ProfilePoint{5, 40}}});
  std::uint64_t hash = 0;
  for (const bool back : {false, true}) {
    Sculpture s = block();
    s.apply(DefineTool{1, tool}).value();
    const ToolPose a{{-20, 0, -15}, kUp}, b{{80, 0, -15}, kUp};
    s.apply(back ? MoveTool{1, b, a, 1} : MoveTool{1, a, b, 1}).value();
    if (back) {
      EXPECT_EQ(s.state_hash(), hash);
    }
    hash = s.state_hash();
  }
}

}  // namespace
}  // namespace kerf::undercut_test
