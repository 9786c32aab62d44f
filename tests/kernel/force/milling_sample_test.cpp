// SPDX-License-Identifier: Apache-2.0
// The mechanistic law sums a sample of the elements of a large tick. The sample's position relative
// to the elements changes from tick to tick, which must not be felt in a steady cut.

#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::milling_sample_test {
namespace {

/// A slot of a flat end mill of 12 mm, oblique to the grid.
struct Slot {
  Rays rays;
  double pitch_mm, depth_mm, angle_rad, step_mm;
};

/// Returns the greatest change of the force from one tick to the next, over the mean force.
double greatest_step(const Slot& slot) {
  Sculpture block = *Sculpture::create({.stock = BoxStock{{-9, -9, -slot.depth_mm - 1}, {9, 9, 0}},
                                        .rays = slot.rays,
                                        .pitch_mm = slot.pitch_mm,
                                        .tolerance_mm = 0.001,
                                        .keep_normals = false,
                                        .force = {.law = ForceLaw::kMechanistic,
                                                  .milling = {.spindle_rpm = 12000,
                                                              .teeth = 2,
                                                              .ripple_hz = 0,
                                                              .cut_n_per_mm2 = {800, 300, 200},
                                                              .edge_n_per_mm = {20, 30, 5}}}});
  block.apply(DefineTool{1, *make_tool(FlatShape{12, 30})}).value();
  const Vec3 along{std::cos(slot.angle_rad), std::sin(slot.angle_rad), 0};
  const auto at = [&](double ticks) {
    const double travel_mm = -3 + ticks * slot.step_mm;
    return ToolPose{Vec3{0.0137, 0.0213, -slot.depth_mm} + along * travel_mm, {0, 0, 1}};
  };
  constexpr int kLead = 12, kTicks = 40;
  block.apply(MoveTool{1, at(-22 / slot.step_mm), at(0), 1, false}).value();
  Vec3 before, sum;
  double step = 0;
  for (int i = 0; i < kLead + kTicks; ++i) {
    const Vec3 force = block.apply(MoveTool{1, at(i), at(i + 1), 0.001}).value().wrench.force_n;
    if (i > kLead) step = std::max(step, length(force - before));
    if (i >= kLead) sum = sum + force;
    before = force;
  }
  return step / length(sum * (1.0 / kTicks));
}

TEST(MillingSample, DeepFlatSlotIsSteadyFromTickToTick) {
  // Some 500 elements of nine parts each: the sum of all has steps of 2.8 %, that of a third 9 %.
  EXPECT_LT(greatest_step({Rays::kDexel, 0.05, 8, M_PI / 4, 0.1}), 0.043);
}

TEST(MillingSample, DeepWallsOfThreeFieldsAreSteadyFromTickToTick) {
  // There are some 25 000 elements in each field of horizontal rays, of which every 25th is summed.
  // If all of these were in every fifth column, steps would be 14 %.
  EXPECT_LT(greatest_step({Rays::kTriDexel, 0.05, 5.2, M_PI / 6, 0.05}), 0.03);
}

}  // namespace
}  // namespace kerf::milling_sample_test
