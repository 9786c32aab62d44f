// SPDX-License-Identifier: Apache-2.0
// The collision wrench of a tool does not depend on how its outline is divided into sections.
#include "kernel/dexel/dexel_field.h"
#include "kernel/force/collision.h"
#include "kernel/force/stock_contact.h"
#include "tests/support/test.h"

namespace kerf::divided_outline_test {
namespace {

constexpr double kPivotMm = 60;
const Vec3 kUp{0, 0, 1};

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double in(double a, double b) { return a + (b - a) * (double(engine_() >> 11) * 0x1p-53); }
  int count(int a, int b) { return a + int(engine_() % std::uint64_t(b - a + 1)); }

 private:
  std::mt19937_64 engine_;
};

/// A straight outline of one to four sections of random shape: cylinders, tapers and steps. Its
/// first point is at height 0.
std::vector<ProfilePoint> random_outline(Random& random) {
  std::vector<ProfilePoint> outline{{random.in(1, 8), 0}};
  for (int n = random.count(1, 4); n > 0; --n) {
    ProfilePoint p = outline.back();
    if (random.count(0, 2) == 0) outline.push_back({random.in(1, 12), p.h_mm});
    p = outline.back();
    const double taper = random.count(0, 1) == 0 ? 0 : random.in(-0.4, 0.6);
    const double height = random.in(3, 25);
    outline.push_back({std::max(0.5, p.r_mm + taper * height), p.h_mm + height});
  }
  return outline;
}

/// Returns the outline with each section divided at random heights, 20 in all at most.
std::vector<ProfilePoint> divided(const std::vector<ProfilePoint>& outline, Random& random) {
  std::vector<ProfilePoint> finer{outline.front()};
  const int most = 20 / int(outline.size() - 1);
  for (std::size_t k = 1; k < outline.size(); ++k) {
    const ProfilePoint a = outline[k - 1], b = outline[k];
    if (b.h_mm > a.h_mm) {
      std::vector<double> shares;
      for (int n = random.count(0, most - 1); n > 0; --n) shares.push_back(random.in(0.01, 0.99));
      std::ranges::sort(shares);
      for (const double s : shares)
        finer.push_back({a.r_mm + (b.r_mm - a.r_mm) * s, a.h_mm + (b.h_mm - a.h_mm) * s});
    }
    finer.push_back(b);
  }
  return finer;
}

ProfileShape shape_of(const std::vector<ProfilePoint>& outline) {
  ProfileShape shape;
  for (const ProfilePoint& p : outline) shape.steps.emplace_back(p);
  return shape;
}

std::vector<HolderSection> holder_of(const std::vector<ProfilePoint>& outline) {
  std::vector<HolderSection> sections;
  for (std::size_t k = 1; k < outline.size(); ++k) {
    const ProfilePoint a = outline[k - 1], b = outline[k];
    if (b.h_mm > a.h_mm) sections.push_back({2 * a.r_mm, 2 * b.r_mm, b.h_mm - a.h_mm});
  }
  return sections;
}

std::vector<std::array<Vec3, 3>> octahedron(Vec3 c, double r) {
  const Vec3 x{r, 0, 0}, y{0, r, 0}, z{0, 0, r};
  std::vector<std::array<Vec3, 3>> faces;
  const Vec3 around[] = {x, y, x * -1, y * -1};
  for (int k = 0; k < 4; ++k) {
    const Vec3 a = c + around[k], b = c + around[(k + 1) % 4];
    faces.push_back({a, b, c + z});
    faces.push_back({b, a, c - z});
  }
  return faces;
}

Obstacle random_obstacle(Random& random) {
  const double r = random.in(5, 15);
  const Vec3 along{random.in(-20, 20), random.in(-20, 20), random.in(5, 20)};
  switch (random.count(0, 3)) {
    case 0:
      return {BoxObstacle{{-r, -r, -r}, {r, random.in(5, 15), random.in(5, 15)}}, 2};
    case 1:
      return {CylinderObstacle{along * -1, along, r}, 2};
    case 2:
      return {SphereObstacle{{}, r}, 2};
    default:
      return {MeshObstacle{octahedron({}, 2 * r)}, 2};
  }
}

ToolPose random_pose(Random& random, double length_mm) {
  const Vec3 axis =
      normalized(Vec3{random.in(-0.8, 0.8), random.in(-0.8, 0.8), random.in(-0.2, 1)});
  const Vec3 at{random.in(-30, 30), random.in(-30, 30), random.in(-30, 30)};
  return {at - axis * (length_mm * random.in(0, 1)), axis};
}

/// Expects equal forces and torques within 1 %, the torque relative to the force and the lever of
/// 10 mm, which also bounds the point of attack.
void expect_alike(const Wrench& a, const Wrench& b, const std::string& which) {
  const double force_n = length(a.force_n);
  EXPECT_LT(length(a.force_n - b.force_n), 0.01 * force_n) << which;
  const double torque_nmm = std::max(length(a.torque_nmm), 10 * force_n);
  EXPECT_LT(length(a.torque_nmm - b.torque_nmm), 0.01 * torque_nmm) << which;
}

TEST(DividedOutline, ObstaclesPushItLikeTheUndividedOutline) {
  Random random(43);
  int sections = 0;
  for (int n = 0; n < 100; ++n) {
    const std::vector<ProfilePoint> outline = random_outline(random);
    const Tool whole = *make_tool(shape_of(outline));
    Wrench push;
    ToolPose pose;
    const Obstacles obstacles({random_obstacle(random)});
    do {
      pose = random_pose(random, whole.length_mm);
      push = obstacles.push(whole, pose, kPivotMm);
    } while (length(push.force_n) < 0.1 || length(push.force_n) > 4);
    for (int k = 0; k < 5; ++k) {
      const Tool tool = *make_tool(shape_of(divided(outline, random)));
      sections = std::max(sections, int(tool.pieces.size()));
      const std::string which = std::to_string(n) + ", " + std::to_string(tool.pieces.size());
      expect_alike(push, obstacles.push(tool, pose, kPivotMm), which);
      std::vector<ContactPlane> planes, of_whole;
      obstacles.planes(tool, pose, planes);
      obstacles.planes(whole, pose, of_whole);
      ASSERT_EQ(planes.size(), of_whole.size()) << which;
      for (std::size_t i = 0; i < planes.size(); ++i) {
        EXPECT_LT(length(planes[i].point_mm - of_whole[i].point_mm), 0.1) << which;
      }
      expect_alike(push, wrench_of(planes, pose, kPivotMm), which);
    }
  }
  EXPECT_GT(sections, 16);
}

TEST(DividedOutline, StockPushesItLikeTheUndividedOutline) {
  constexpr double kPitch = 0.4, kAllowance = 0.01;
  Random random(44);
  const BoxStock block{{-20, -20, -20}, {20, 20, 20}};
  std::vector<DexelField> fields;
  for (const RayAxis axis : {RayAxis::kZ, RayAxis::kX, RayAxis::kY})
    fields.emplace_back(block, kPitch, axis);
  const ForceSettings settings{.contact_stiffness_n_per_mm = 2};
  for (int n = 0; n < 100; ++n) {
    const std::vector<ProfilePoint> outline = random_outline(random);
    const auto tool_of = [&](const std::vector<ProfilePoint>& holder) {
      return *make_tool(FlatShape{0.5, 5}, {.shank = {}, .holder = holder_of(holder)});
    };
    const Tool whole = tool_of(outline);
    const std::span<const DexelField> used(fields.data(), n % 2 == 0 ? 1 : 3);
    ToolPose pose;
    StockContact contact;
    do {
      pose = random_pose(random, whole.whole_length_mm);
      contact = stock_contact(whole, pose, used, settings, kAllowance);
    } while (contact.depth_mm < 0.05 || contact.depth_mm > 3);
    for (int k = 0; k < 5; ++k) {
      const Tool tool = tool_of(divided(outline, random));
      const StockContact c = stock_contact(tool, pose, used, settings, kAllowance);
      const std::string which = std::to_string(n) + ", " + std::to_string(tool.non_cutting.size());
      EXPECT_NEAR(c.depth_mm, contact.depth_mm, 0.01 * contact.depth_mm) << which;
      expect_alike(contact.wrench, c.wrench, which);
      const ToolMotion motion = make_motion(pose, pose, 100);
      EXPECT_NEAR(deepest_stock_contact(tool, motion, used, kAllowance), c.depth_mm, 1e-9) << which;
    }
  }
}

/// A section that was rounded to 0.001 mm is no longer in line with its neighbors.
TEST(DividedOutline, MayBeRoundedToMicrometers) {
  Random random(45);
  for (int n = 0; n < 40; ++n) {
    const std::vector<ProfilePoint> outline = random_outline(random);
    const Tool whole = *make_tool(shape_of(outline));
    const Obstacles obstacles({random_obstacle(random)});
    ToolPose pose;
    Wrench push;
    do {
      pose = random_pose(random, whole.length_mm);
      push = obstacles.push(whole, pose, kPivotMm);
    } while (length(push.force_n) < 0.5 || length(push.force_n) > 4);
    std::vector<ProfilePoint> finer = divided(outline, random);
    for (ProfilePoint& p : finer) {
      p = {std::round(1000 * p.r_mm) / 1000, std::round(1000 * p.h_mm) / 1000};
    }
    const Wrench w = obstacles.push(*make_tool(shape_of(finer)), pose, kPivotMm);
    const double allowed_n = 0.01 * length(push.force_n) + 2 * 2 * 0.002;
    EXPECT_LT(length(w.force_n - push.force_n), allowed_n) << n;
  }
}

/// A ball end drawn as arcs, and the ball of a plain shape.
TEST(DividedOutline, BallsMayBeDrawnAsArcs) {
  Random random(46);
  const Tool whole = *make_tool(BallShape{10, 40});
  ASSERT_EQ(whole.whole_parts.size(), 1);
  for (int n = 0; n < 100; ++n) {
    std::vector<double> angles{std::numbers::pi / 2};
    for (int k = random.count(0, 8); k > 0; --k)
      angles.push_back(random.in(0.05, std::numbers::pi / 2 - 0.05));
    std::ranges::sort(angles);
    ProfileShape shape{{ProfilePoint{0, 0}}};
    for (const double a : angles)
      shape.steps.emplace_back(ProfileArc{{5 * std::sin(a), 5 - 5 * std::cos(a)}, 5});
    shape.steps.emplace_back(ProfilePoint{5, 40});
    const Tool tool = *make_tool(shape);
    EXPECT_EQ(tool.whole_parts.size(), 1) << n;
    const Obstacles obstacles({random_obstacle(random)});
    ToolPose pose;
    Wrench push;
    do {
      pose = random_pose(random, 20);
      push = obstacles.push(whole, pose, kPivotMm);
    } while (length(push.force_n) < 0.1 || length(push.force_n) > 4);
    expect_alike(push, obstacles.push(tool, pose, kPivotMm), std::to_string(n));
  }
}

TEST(DividedOutline, FlatObstaclesPushEveryTipByItsDepth) {
  const Obstacles floor({{BoxObstacle{{-50, -50, -20}, {50, 50, 1}}, 1}});
  ProfileShape halves{
      {ProfilePoint{0, 0}, ProfileArc{{4, 2}, 5}, ProfileArc{{5, 5}, 5}, ProfilePoint{5, 40}}};
  std::vector<ProfilePoint> straight{{5, 0}};
  for (int k = 1; k <= 20; ++k) straight.push_back({5, 2.0 * k});
  const ToolBody body{.shank = Shank{10, 30}, .holder = std::vector<HolderSection>{{10, 10, 20}}};
  for (const ToolShape& shape :
       {ToolShape{FlatShape{10, 40}}, ToolShape{BallShape{10, 40}},
        ToolShape{BullNoseShape{10, 2, 40}}, ToolShape{TaperShape{6, 8, 40, TaperTip::kBall}},
        ToolShape{ConeEndShape{10, 90, 40}}, ToolShape{halves}, ToolShape{shape_of(straight)}}) {
    for (const Tool& tool : {*make_tool(shape), *make_tool(shape, body)}) {
      const Wrench w = floor.push(tool, {{3, 2, 0}, kUp}, kPivotMm);
      EXPECT_NEAR(w.force_n.z, 1, 1e-3) << shape.index();
      EXPECT_NEAR(length(Vec3{w.force_n.x, w.force_n.y, 0}), 0, 1e-6) << shape.index();
    }
  }
}

TEST(DividedOutline, HolderInTheSideOfTheStockIsPushedSideways) {
  const BoxStock block{{0, -20, -20}, {20, 20, 20}};
  const std::vector<DexelField> fields{DexelField(block, 0.25, RayAxis::kZ)};
  const auto force_of = [&](int sections) {
    const std::vector<HolderSection> holder(std::size_t(sections), {20, 20, 40.0 / sections});
    const Tool tool = *make_tool(FlatShape{2, 10}, {.shank = {}, .holder = holder});
    return stock_contact(tool, {{-9.13, 0, -25}, kUp}, fields, {}, 0).wrench.force_n;
  };
  const Vec3 whole = force_of(1);
  EXPECT_LT(whole.x, -0.5);
  EXPECT_NEAR(whole.z, 0, 1e-9);
  for (const int sections : {2, 6, 20}) {
    EXPECT_LT(length(force_of(sections) - whole), 1e-9) << sections;
  }
}

/// A shank and a wider holder that touch a wall together push once. As one of them leaves it, the
/// push remains continuous.
TEST(DividedOutline, PartsThatTouchOneFaceShareItsPush) {
  const Obstacles wall({{BoxObstacle{{0, -50, -50}, {50, 50, 50}}, 1}});
  const Tool tool =
      *make_tool(FlatShape{2, 10},
                 {.shank = Shank{10, 20}, .holder = std::vector<HolderSection>{{16, 16, 20}}});
  const auto push_at = [&](double lean) {
    const Vec3 axis{std::sin(lean), 0, std::cos(lean)};
    // The shank's lower rim is 1 mm deep in the wall.
    const Vec3 rim = axis * 10 + Vec3{std::cos(lean), 0, -std::sin(lean)} * 5;
    return wall.push(tool, {Vec3{1, 0, 0} - rim, axis}, kPivotMm);
  };
  // The holder's rim is 3 mm farther out and 20 mm higher, so it is as deep at this angle.
  const double even = -std::atan(3.0 / 20);
  EXPECT_NEAR(push_at(even).force_n.x, -1, 1e-3);
  Wrench before = push_at(even - 0.05);
  for (double lean = even - 0.05; lean < even + 0.05; lean += 1e-4) {
    const Wrench w = push_at(lean);
    EXPECT_LT(length(w.force_n - before.force_n), 0.01) << lean;
    EXPECT_LT(length(w.torque_nmm - before.torque_nmm), 0.5) << lean;
    before = w;
  }
}

}  // namespace
}  // namespace kerf::divided_outline_test
