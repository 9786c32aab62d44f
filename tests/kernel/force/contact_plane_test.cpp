// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/contact_plane.h"

#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::contact_plane_test {
namespace {

const Vec3 kUp{0, 0, 1};

/// Returns a block with a ball next to it, and tool 1: a cutter of 2 mm with a shank of 10 mm.
Sculpture block_and_ball() {
  auto s = *Sculpture::create({.stock = BoxStock{{0, -20, -20}, {20, 20, 20}},
                               .pitch_mm = 0.5,
                               .obstacles = {{SphereObstacle{{-12, 0, 0}, 6}, 2}}});
  ToolBody body{.shank = Shank{10, 100}};
  s.apply(DefineTool{1, *make_tool(FlatShape{2, 10}, body)}).value();
  return s;
}

double length_of_difference(const Wrench& a, const Wrench& b) {
  return length(a.force_n - b.force_n) + length(a.torque_nmm - b.torque_nmm);
}

TEST(ContactPlane, PlanesOfAToolGiveItsCollisionWrench) {
  const Sculpture s = block_and_ball();
  int touching = 0;
  for (double x = -8; x <= 2; x += 0.5) {
    const ToolPose pose{{x, 1, -15}, normalized({0.05, 0.1, 1})};
    const std::vector<ContactPlane> planes = s.contact(1, pose, true);
    const Wrench collision = s.collision(1, pose);
    EXPECT_LT(length_of_difference(wrench_of(planes, pose, s.settings().force.pivot_mm), collision),
              1e-9)
        << x;
    touching += collision == Wrench{} ? 0 : 1;
  }
  EXPECT_GT(touching, 10);
}

TEST(ContactPlane, DeepestComesFirst) {
  const std::vector<ContactPlane> planes = block_and_ball().contact(1, {{-3, 0, -15}, kUp}, true);
  ASSERT_GE(planes.size(), 2u);
  EXPECT_TRUE(std::ranges::is_sorted(planes, std::greater{}, &ContactPlane::depth_mm));
}

TEST(ContactPlane, ObstaclesAreReportedWithinReach) {
  const Sculpture s = block_and_ball();
  const auto gap_at = [&s](double x) {
    double gap = std::numeric_limits<double>::infinity();
    for (const ContactPlane& p : s.contact(1, {{x, 0, -60}, kUp}, true)) {
      if (!p.stock) gap = -p.depth_mm;
    }
    return gap;
  };
  EXPECT_NEAR(gap_at(-12 + 6 + 5 + 3), 3, 1e-6);  // The shank's axis is 3 + 5 mm from the ball.
  EXPECT_GT(gap_at(-40), kContactReachMm);
}

TEST(ContactPlane, StockTouchesTheCuttingPartOnlyIfTheToolDoesNotCut) {
  const Sculpture s = block_and_ball();
  const ToolPose pose{{10, 0, 15}, kUp};  // The cutter is 5 mm deep, the shank above the block.
  EXPECT_TRUE(s.contact(1, pose, true).empty());
  EXPECT_FALSE(s.contact(1, pose, false).empty());
}

TEST(ContactPlane, UnknownToolAndBadPoseGiveNoPlanes) {
  const Sculpture s = block_and_ball();
  EXPECT_TRUE(s.contact(2, {{10, 0, 10}, kUp}, false).empty());
  EXPECT_TRUE(s.contact(1, {{10, 0, 10}, {0, 0, 5}}, false).empty());
}

}  // namespace
}  // namespace kerf::contact_plane_test
