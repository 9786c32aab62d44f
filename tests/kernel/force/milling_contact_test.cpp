// SPDX-License-Identifier: Apache-2.0
// Where and when the tool of the mechanistic law touches the elements that it cut: light cuts, long
// motions and the phase of the spindle.

#include "kernel/force/milling_elements.h"
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::milling_contact_test {
namespace {

const Vec3 kUp{0, 0, 1};

Sculpture block(const MillingSettings& milling, Rays rays) {
  Sculpture result =
      *Sculpture::create({.stock = BoxStock{{-12, -12, -4}, {12, 12, 0}},
                          .rays = rays,
                          .pitch_mm = 0.1,
                          .tolerance_mm = 0.001,
                          .keep_normals = false,
                          .force = {.law = ForceLaw::kMechanistic, .milling = milling}});
  result.apply(DefineTool{1, *make_tool(FlatShape{6, 30})}).value();
  return result;
}

/// Edge forces only, as a mean over the spindle's turn, so they do not depend on the step.
MillingSettings edges() { return MillingSettings{.ripple_hz = 0, .edge_n_per_mm = {13, 10, 2.8}}; }

/// Returns the mean force of a slot along +X.
Vec3 slot_force(Rays rays, double depth_mm, double step_mm) {
  Sculpture b = block(edges(), rays);
  const auto at = [&](double x) { return ToolPose{{x, 0.0213, -depth_mm}, kUp}; };
  b.apply(MoveTool{1, at(-20), at(-4), 1, false}).value();
  const int lead = static_cast<int>(0.5 / step_mm), ticks = static_cast<int>(2 / step_mm);
  Vec3 sum;
  for (int i = 0; i < lead + ticks; ++i) {
    const auto r = b.apply(MoveTool{1, at(-4 + i * step_mm), at(-4 + (i + 1) * step_mm), 0.001});
    if (i >= lead) sum = sum + r->wrench.force_n * (1.0 / ticks);
  }
  return sum;
}

TEST(MillingContact, LightCutTouchesTheWallNotTheFloor) {
  // One field samples any depth exactly, and the edges alone within 8 % where rows of rays are
  // unevenly distributed about the tool, at any depth.
  for (const double depth_mm : {0.01, 0.02}) {
    const Vec3 model{-2 * 10 * depth_mm / M_PI, 2 * 13 * depth_mm / M_PI, -2.8 * depth_mm};
    for (const double step_mm : {0.005, 0.03, 0.045, 0.06}) {
      const Vec3 got = slot_force(Rays::kDexel, depth_mm, step_mm);
      EXPECT_LT(length(got - model), 0.08 * length(model))
          << depth_mm << " mm in steps of " << step_mm << ": " << got.x << " " << got.y << " "
          << got.z << ", wanted " << model.x << " " << model.y << " " << model.z;
    }
  }
}

/// Returns the evaluations of the tool's surface for `groups` full groups of columns of a length in
/// µm, cut by a flat mill of 6 mm that moved by `path_mm` along +X.
std::int64_t evaluations_of(int groups, double path_mm, int length_um = 2000) {
  const DexelGrid grid{{0, 0, -2}, 0.1, 0.001, 8, groups, 2000};
  Removal removal;
  RemovedPart& part = removal.start(1).front();
  for (int j = 0; j < groups; ++j) {
    RemovedGroup g{0, j, {}, {}};
    for (int& top : g.top) top = length_um;
    part.groups.push_back(g);
    part.quanta += 8 * length_um;
  }
  part.tiles = {{{0, 0}, part.groups.size()}};
  MillingSettings milling = edges();
  milling.ripple_hz = 250;
  const Harmonics harmonics = harmonics_of(milling);
  const ToolSide side(*make_tool(FlatShape{6, 30}));
  std::int64_t evaluations = 0;
  const double tip_y = std::fmod(groups * 0.05, 3.0);
  sum_milling(removal, grid,
              {.settings = milling,
               .harmonics = harmonics,
               .side = side,
               .twist = {{path_mm, 0, 0}, {}},
               .frame = {{0.4 - path_mm / 2, tip_y, -2}, kUp, 10, 30, 3},
               .zero = {1, 0, 0},
               .feed_per_mm = 1,
               .weighted = false,
               .evaluations = &evaluations});
  return evaluations;
}

TEST(MillingContact, CostsFewEvaluationsPerColumn) {
  constexpr int kGroups = 40, kColumns = 8 * kGroups, kParts = 4;
  // A tick finds the surface at once, and sums about 1024 parts at most, or below 2048 elements in
  // walls along the rays, whose elements are longer than a pitch.
  EXPECT_LE(evaluations_of(kGroups / 4, 0.03), kColumns * kParts / 4);
  EXPECT_LE(evaluations_of(kGroups, 0.03), 1536);
  EXPECT_LE(evaluations_of(1000, 0.03, 90), 1536);
  for (const int groups : {100, 200, 255, 257, 1000})
    EXPECT_LE(evaluations_of(groups, 0.03), 2048 * kParts) << groups;
  EXPECT_LE(evaluations_of(kGroups, 0.12), kColumns * (kParts + 3) * 8);
  EXPECT_LE(evaluations_of(kGroups, 10), kColumns * (kParts + 3) * 8);
}

TEST(MillingContact, CostsOfALongMotionAreBounded) {
  EXPECT_LE(evaluations_of(1000, 80), 16384 * 8);
  EXPECT_LE(evaluations_of(12000, 80), 16384 * 8);
}

TEST(MillingContact, SpindlePhaseSurvivesAChangeOfReferenceDirection) {
  // The perpendicular of an axis is computed across its smallest component, which changes here.
  MillingSettings m{
      .spindle_rpm = 6000, .helix_deg = 0, .ripple_hz = 250, .cut_n_per_mm2 = {800, 300, 200}};
  const auto forces = [&](double tilt) {
    Sculpture b = block(m, Rays::kTriDexel);
    const auto at = [&](int i) {
      const double heading = M_PI / 4 + (i - 20.5) * 0.02;
      const Vec3 lean{tilt * std::sin(heading), tilt * std::cos(heading), 1};
      return ToolPose{{-4 + i * 0.03, 0.02, -2}, normalized(lean)};
    };
    b.apply(MoveTool{1, {{-20, 0.02, -2}, at(0).axis}, at(0), 1, false}).value();
    std::vector<Vec3> result;
    for (int i = 0; i < 40; ++i)
      result.push_back(b.apply(MoveTool{1, at(i), at(i + 1), 0.001})->wrench.force_n);
    return result;
  };
  const std::vector<Vec3> upright = forces(0), leaning = forces(1e-6);
  for (std::size_t i = 0; i < upright.size(); ++i)
    EXPECT_LT(length(upright[i] - leaning[i]), 0.01 * length(upright[i]) + 1) << i;
}

}  // namespace
}  // namespace kerf::milling_contact_test
