// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/stock_contact.h"

#include "kernel/math/rotation.h"
#include "kernel/sculpture.h"
#include "tests/support/swept_oracle.h"
#include "tests/support/test.h"

namespace kerf::stock_contact_test {
namespace {

const Vec3 kUp{0, 0, 1};
const BoxStock kBlock{{0, -20, -20}, {20, 20, 20}};
constexpr double kPitch = 0.25;

std::vector<DexelField> fields(std::vector<RayAxis> axes, const StockShape& stock = kBlock) {
  std::vector<DexelField> all;
  for (const RayAxis axis : axes) all.emplace_back(stock, kPitch, axis);
  return all;
}

Tool tool_with_shank(double diameter_mm) {
  ToolBody body{.shank = Shank{diameter_mm, 100}};
  return *make_tool(FlatShape{2, 10}, body);
}

StockContact contact(const Tool& tool, const ToolPose& pose, const std::vector<DexelField>& in) {
  ForceSettings settings{.contact_stiffness_n_per_mm = 3};
  return stock_contact(tool, pose, in, settings, 0);
}

TEST(StockContact, ShankAgainstAWallIsPushedByItsDepth) {
  // The wall is the plane x = 0, the shank's axis is 4 mm in front of it, its radius 5 mm.
  const ToolPose pose{{-4, 0, -30}, kUp};
  const StockContact c = contact(tool_with_shank(10), pose, fields({RayAxis::kZ}));
  EXPECT_LE(c.depth_mm, 1);
  EXPECT_GE(c.depth_mm, 1 - kPitch);  // Rays along Z locate the wall to the pitch.
  EXPECT_NEAR(length(c.wrench.force_n), 3 * c.depth_mm, 1e-9);
  EXPECT_NEAR(c.wrench.force_n.x, -3 * c.depth_mm, 1e-3);
  EXPECT_NEAR(c.wrench.force_n.y, 0, 0.02);  // The centroid is that of sampled columns.
  EXPECT_NEAR(c.wrench.force_n.z, 0, 1e-9);
  // The overlap's centroid is at z = 0, 30 below the pivot: (x, 0, -30) x (-f, 0, 0) = (0, 30 f,
  // 0).
  EXPECT_NEAR(c.wrench.torque_nmm.y, 30 * 3 * c.depth_mm, 0.1);
  EXPECT_NEAR(c.wrench.torque_nmm.z, 0, 1e-9);
}

TEST(StockContact, RaysAcrossTheWallMeasureTheDepthExactly) {
  const ToolPose pose{{-4, 0.5 * kPitch, -30}, kUp};
  const auto all = fields({RayAxis::kZ, RayAxis::kX, RayAxis::kY});
  EXPECT_NEAR(contact(tool_with_shank(10), pose, all).depth_mm, 1, 1e-6);
}

TEST(StockContact, HorizontalShankOnTheTopIsLifted) {
  const ToolPose pose{{-60, 0.5 * kPitch, 20 + 5 - 0.5}, {1, 0, 0}};
  const StockContact c = contact(tool_with_shank(10), pose, fields({RayAxis::kZ}));
  EXPECT_NEAR(c.depth_mm, 0.5, 1e-6);
  EXPECT_NEAR(c.wrench.force_n.z, 1.5, 1e-2);
  EXPECT_NEAR(c.wrench.force_n.x, 0, 1e-6);
}

TEST(StockContact, HolderFaceOnTheBlockIsLiftedWithoutTorque) {
  ToolBody body{.holder = std::vector<HolderSection>{{16, 16, 30}}};
  const Tool tool = *make_tool(FlatShape{2, 10}, body);
  const StockContact c = contact(tool, {{10, 0, 10 - 0.3}, kUp}, fields({RayAxis::kZ}));
  EXPECT_NEAR(c.depth_mm, 0.3, 1e-6);
  EXPECT_NEAR(c.wrench.force_n.z, 0.9, 1e-6);
  EXPECT_NEAR(c.wrench.torque_nmm.x, 0, 0.15);  // At most half a pitch off the axis.
  EXPECT_NEAR(c.wrench.torque_nmm.y, 0, 0.15);
}

/// The deepest point is on the shank's axis, and the overlap is symmetric: all directions across
/// the axis are equally short.
TEST(StockContact, SymmetricallyBuriedShankIsPushedSideways) {
  const Tool tool = *make_tool(FlatShape{0.2, 10}, {.shank = Shank{0.6, 100}, .holder = {}});
  const double middle_mm = 0.5 * kPitch;  // of a column
  const StockContact c =
      contact(tool, {{10 + middle_mm, middle_mm, -60}, kUp}, fields({RayAxis::kZ}));
  EXPECT_NEAR(c.depth_mm, 0.3, 1e-6);
  EXPECT_NEAR(length(c.wrench.force_n), 3 * c.depth_mm, 1e-9);
  EXPECT_NEAR(c.wrench.force_n.z, 0, 1e-9);
}

TEST(StockContact, IsZeroWithoutShankOrOutsideTheBlock) {
  const auto z = fields({RayAxis::kZ});
  const Tool bare = *make_tool(FlatShape{2, 10});
  EXPECT_EQ(contact(bare, {{10, 0, -15}, kUp}, z).depth_mm, 0);
  const Tool tool = tool_with_shank(10);
  for (const Vec3 tip : {Vec3{10, 0, 10.001}, Vec3{-5.001, 0, -15}, Vec3{10, 26, -15}}) {
    const StockContact c = contact(tool, {tip, kUp}, z);
    EXPECT_EQ(c.depth_mm, 0);
    EXPECT_EQ(c.wrench, Wrench{});
  }
}

TEST(StockContact, AllowanceIsSubtractedFromTheDepth) {
  const ToolPose pose{{-60, 0.5 * kPitch, 24.5}, {1, 0, 0}};
  const auto z = fields({RayAxis::kZ});
  EXPECT_NEAR(stock_contact(tool_with_shank(10), pose, z, {}, 0.2).depth_mm, 0.3, 1e-6);
  EXPECT_EQ(stock_contact(tool_with_shank(10), pose, z, {}, 0.51).depth_mm, 0);
}

/// Returns the depth of a point in a piece, ignoring its top; negative outside.
double depth_in(const ToolPiece& piece, const ToolPose& pose, Vec3 point) {
  if (test::outside(piece, pose, point) > 0) return -1;
  const Vec3 p = point - pose.tip_mm;
  const double h = dot(p, pose.axis), r = length(p - pose.axis * h);
  if (const auto* b = std::get_if<BallPiece>(&piece)) {
    return b->radius_mm - std::hypot(r, h - b->center_mm);
  }
  if (const auto* a = std::get_if<ArcPiece>(&piece)) {
    const double n = std::hypot(std::max(0.0, r - a->center_r_mm), h - a->center_z_mm);
    return std::min(a->radius_mm - n, h - a->z0_mm);
  }
  const auto& f = std::get<FrustumPiece>(piece);
  const double angle = std::atan2(f.r1_mm - f.r0_mm, f.z1_mm - f.z0_mm);
  const double side = (f.r0_mm - r) * std::cos(angle) + (h - f.z0_mm) * std::sin(angle);
  return std::min(side, h - f.z0_mm);
}

TEST(StockContact, MatchesBruteForceOverAllColumns) {
  std::mt19937_64 random(5);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * (double(random() >> 11) / 9007199254740992.0);
  };
  const BoxStock small{{0, 0, 0}, {6, 6, 6}};
  int touching = 0;
  for (int i = 0; i < 60; ++i) {
    const std::vector<ToolPiece> pieces{FrustumPiece{4, uniform(0.5, 3), 9, uniform(0.5, 3)},
                                        ArcPiece{uniform(-1, 3), 11, 3, 9.5, 13},
                                        BallPiece{16, uniform(0.5, 3)}};
    const Tool tool = *make_tool({FrustumPiece{0, 1, 4, 1}}, {pieces[std::size_t(i % 3)]});
    const Vec3 axis = normalized({uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
    const Vec3 middle{uniform(-1, 7), uniform(-1, 7), uniform(-1, 7)};
    const ToolPose pose{middle - axis * 11, axis};
    const auto z = fields({RayAxis::kZ}, small);
    double deepest = 0;
    for (double x = kPitch / 2; x < 6; x += kPitch) {
      for (double y = kPitch / 2; y < 6; y += kPitch) {
        for (int k = 0; k <= 1200; ++k) {
          const double d = depth_in(tool.non_cutting[0], pose, {x, y, k * 0.005});
          deepest = std::max(deepest, d);
        }
      }
    }
    const StockContact c = contact(tool, pose, z);
    EXPECT_NEAR(c.depth_mm, deepest, 0.005) << i;
    EXPECT_GE(c.depth_mm, deepest - 1e-6) << i;
    if (deepest > 0) {
      ++touching;
      EXPECT_NEAR(length(c.wrench.force_n), 3 * c.depth_mm, 1e-9);
    }
  }
  EXPECT_GT(touching, 30);
}

TEST(StockContact, IsReportedByAMotionAndAddedToItsForce) {
  auto s = *Sculpture::create(
      {.stock = kBlock, .pitch_mm = kPitch, .force = {.contact_stiffness_n_per_mm = 3}});
  s.apply(DefineTool{1, tool_with_shank(10)}).value();
  // A cutter of 2 mm drills 15 mm deep; its shank starts at a height of 10 mm.
  const auto free = s.apply(MoveTool{1, {{10, 0, 30}, kUp}, {{10, 0, 10.5}, kUp}, 0.1}).value();
  EXPECT_EQ(free.stock_contact_mm, 0);
  EXPECT_EQ(free.collision, Wrench{});
  const auto deep = s.apply(MoveTool{1, {{10, 0, 10.5}, kUp}, {{10, 0, 5}, kUp}, 0.1}).value();
  EXPECT_GT(deep.stock_contact_mm, 3.9);
  EXPECT_GT(deep.collision.force_n.z, 0);
  EXPECT_EQ(s.collision(1, {{10, 0, 5}, kUp}), deep.collision);
  const auto unfelt =
      s.apply(MoveTool{1, {{10, 0, 5}, kUp}, {{10, 0, 5}, kUp}, 0.1, false}).value();
  EXPECT_EQ(unfelt.stock_contact_mm, deep.stock_contact_mm);
  EXPECT_EQ(unfelt.collision, Wrench{});
}

TEST(StockContact, IsFoundAlongTheMotion) {
  auto s = *Sculpture::create({.stock = kBlock, .pitch_mm = kPitch});
  s.apply(DefineTool{1, tool_with_shank(10)}).value();
  // The shank's lower end passes 2 mm below the block's top, from one side to the other.
  const auto r = s.apply(MoveTool{1, {{-10, 0, 8}, kUp}, {{40, 0, 8}, kUp}, 1}).value();
  EXPECT_NEAR(r.stock_contact_mm, 2, 0.05);
  EXPECT_EQ(r.collision, Wrench{});
}

}  // namespace
}  // namespace kerf::stock_contact_test
