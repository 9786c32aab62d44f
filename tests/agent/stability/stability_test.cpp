// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/stability/experiments.h"
#include "tests/agent/stability/face_rest.h"
#include "tests/agent/stability/held_cut.h"
#include "tests/agent/stability/shipped_scenes.h"
#include "tests/agent/stability/surround.h"
#include "tests/support/test.h"

namespace kerf::agent::stability_test {
namespace {

TEST(Stability, ModelIsStableUpTo250MsRoundTrip) {
  for (const LineQuality& line :
       {LineQuality{.rtt_ms = 0}, LineQuality{.rtt_ms = 25, .jitter = 0.2},
        LineQuality{.rtt_ms = 100, .jitter = 0.2, .loss = 0.02},
        LineQuality{.rtt_ms = 250, .bursts = true}}) {
    for (const bool copy : {true, false}) {
      const SwingOutcome outcome =
          swing({.mode = ForceMode::kModel, .line = line, .damping_n_s_per_m = 20, .copy = copy});
      EXPECT_TRUE(outcome.stable()) << line.rtt_ms << " ms: " << outcome.fastest_mm_per_s
                                    << " mm/s, " << outcome.returned_mj << " mJ";
      EXPECT_GT(outcome.max_force_n, 0.2) << "the test requires a force";
    }
  }
}

/// The lightest device and hand, and a heavy and stiff one, with the greatest latency and none.
std::vector<Press> presses() {
  std::vector<Press> all;
  for (const std::uint64_t latency_us : {0U, 3000U}) {
    for (const bool sideways : {false, true}) {
      Press press{.mechanics = {.mass_kg = 0.05,
                                .inertia_kg_m2 = 1e-5,
                                .hand_n_per_mm = 0.02,
                                .hand_nmm_per_rad = 13,
                                .latency_us = latency_us},
                  .line = {.rtt_ms = 50},
                  .sideways = sideways,
                  .loses_ticks = true};
      all.push_back(press);
      press.obstacle = true;
      all.push_back(press);
      press.mechanics.mass_kg = 0.5;
      press.mechanics.inertia_kg_m2 = 2e-4;
      press.mechanics.hand_n_per_mm = 2;
      press.mechanics.hand_nmm_per_rad = 1340;
      all.push_back(press);
    }
  }
  return all;
}

TEST(Stability, PressedToolRestsAtAnyLatencyOfTheDevice) {
  for (const Press& p : presses()) {
    const PressOutcome outcome = press(p);
    const std::string which = std::to_string(p.mechanics.latency_us) + " us, " +
                              std::to_string(p.mechanics.mass_kg) + " kg, " +
                              (p.sideways ? "sideways, " : "along the axis, ") +
                              (p.obstacle ? "obstacle" : "stock");
    EXPECT_LE(outcome.buzz_mm_per_s, 5) << which;
    EXPECT_LE(outcome.returned_mj, PassivitySettings{}.tank_mj) << which;
    EXPECT_EQ(outcome.trips, 0U) << which;
    EXPECT_GT(outcome.force_n, 0.002) << which << ": the test requires a contact";
  }
}

TEST(Stability, PressedToolBuzzesIfTheDeviceDeclaresNoLatency) {
  double worst = 0;
  for (Press p : presses()) {
    p.ignores_latency = true;
    worst = std::max(worst, press(p).buzz_mm_per_s);
  }
  EXPECT_GT(worst, 10);
}

HandHeldCut held(double mass_kg, double inertia_kg_m2, double n_per_mm, std::uint64_t latency_us) {
  return {.mechanics = {.mass_kg = mass_kg,
                        .inertia_kg_m2 = inertia_kg_m2,
                        .hand_n_per_mm = n_per_mm,
                        .hand_nmm_per_rad = 670 * n_per_mm,
                        .latency_us = latency_us}};
}

TEST(Stability, YieldingHandsFeelTheComputedCut) {
  HandHeldCut milling = held(0.05, 1e-5, 2, 0);
  milling.mechanistic = true;
  for (const HandHeldCut& cut : {held(0.05, 1e-5, 2, 0), held(0.05, 2e-4, 0.5, 0),
                                 held(0.05, 1e-5, 2, 1000), held(0.3, 2e-4, 0.5, 3000), milling}) {
    const HeldCutOutcome outcome = cut_by_hand(cut);
    const std::string which = std::to_string(cut.mechanics.mass_kg) + " kg, " +
                              std::to_string(cut.mechanics.inertia_kg_m2) + " kg m2";
    EXPECT_LE(outcome.force.error(), 0.05) << which;
    EXPECT_LE(outcome.torque.error(), 0.05) << which;
    EXPECT_LE(outcome.returned_mj, 0.1) << which;
    EXPECT_EQ(outcome.trips, 0U) << which;
    EXPECT_GT(outcome.force.computed_mean(), 0.6) << which << ": the test requires a cut";
  }
}

TEST(Stability, TheSpindleDoesNotShakeAToolInASoftHand) {
  HandHeldCut milling = held(0.3, 2e-4, 0.5, 0);
  milling.mechanistic = true;
  const HeldCutOutcome outcome = cut_by_hand(milling);
  EXPECT_LE(outcome.force.error(), 0.1);
  EXPECT_LE(outcome.chatter_mm_per_s, 15) << "much of this is how the hand yields";
  EXPECT_GT(outcome.force.computed_mean(), 0.6) << "the test requires a cut";
}

TEST(Stability, ASlowCutDoesNotShakeASoftHand) {
  HandHeldCut slow = held(0.05, 3e-5, 0.5, 0);
  slow.mm_per_s = 5;
  const HeldCutOutcome outcome = cut_by_hand(slow);
  EXPECT_LE(outcome.force.error(), 0.2);
  EXPECT_GT(outcome.force.computed_mean(), 0.6) << "the test requires a cut";
}

TEST(Stability, WeakGripRestsOnAPathWithATurningAxis) {
  // Along such a path the spring of the axis also pushes the tip, and so moves less inertia.
  constexpr const char* kTurningPath = kPressedGuides[4];
  const PressOutcome outcome = press({.mechanics = {.mass_kg = 0.944,
                                                    .inertia_kg_m2 = 9.21e-5,
                                                    .hand_n_per_mm = 0.942,
                                                    .hand_nmm_per_rad = 32.3,
                                                    .latency_us = 2154},
                                      .loses_ticks = true,
                                      .guides = kTurningPath});
  EXPECT_LE(outcome.buzz_mm_per_s, 0.5);
  EXPECT_LE(outcome.returned_mj, 1);
  EXPECT_GT(outcome.most_force_n, 0.5) << "the test requires the guide";
}

TEST(Stability, EveryGuideIsPassiveAndRestsAtAnyLatencyOfTheDevice) {
  for (const char* guides : kPressedGuides) {
    double felt_n = 0;
    for (Press p : presses()) {
      if (p.obstacle && p.mechanics.mass_kg < 0.1) continue;
      p.obstacle = false;
      p.guides = guides;
      const PressOutcome outcome = press(p);
      const std::string which = std::string(guides) + ", " +
                                std::to_string(p.mechanics.latency_us) + " us, " +
                                std::to_string(p.mechanics.mass_kg) + " kg" +
                                (p.sideways ? ", sideways" : ", along the axis");
      EXPECT_LE(outcome.buzz_mm_per_s, 5) << which;
      EXPECT_LE(outcome.returned_mj, PassivitySettings{}.tank_mj) << which;
      EXPECT_EQ(outcome.trips, 0U) << which;
      felt_n = std::max(felt_n, outcome.most_force_n);
    }
    EXPECT_GT(felt_n, 0.3) << guides << ": the test requires a force";
  }
}

TEST(Stability, GuidesDoNotChangeTheCut) {
  const Recording recording = record_carving(2);
  const std::string path = R"([{"kind":"path","within_mm":0.1,"paths":[[[0,0,0,0,0,1]]]}])";
  EXPECT_EQ(carved_volume_mm3(recording, path), carved_volume_mm3(recording, ""));
}

TEST(Stability, WithAReplicaTheForceIsAccurateAtAnyDelay) {
  const Recording recording = record_carving(4);
  EXPECT_LT(force_error(recording, ForceMode::kModel, {.rtt_ms = 0}, true), 0.05);
  EXPECT_LT(force_error(recording, ForceMode::kModel, {.rtt_ms = 25}, true), 0.05);
  EXPECT_LT(force_error(recording, ForceMode::kModel, {.rtt_ms = 100}, true), 0.05);
  const LineQuality poor{.rtt_ms = 100, .jitter = 0.2, .loss = 0.02};
  EXPECT_LT(force_error(recording, ForceMode::kModel, poor, true), 0.1);
}

TEST(Stability, CutsOfAnotherAgentAreFeltInTime) {
  const Recording both = beside_another(record_carving(6), 0.05);
  const LineQuality line{.rtt_ms = 100};
  EXPECT_LT(force_error(both, ForceMode::kModel, line, true), 0.15);
  EXPECT_GT(force_error(both, ForceMode::kModel, line, true, false), 0.4) << "without intent";
  const LineQuality uneven{.rtt_ms = 100, .jitter = 0.2};
  EXPECT_LT(force_error(both, ForceMode::kModel, uneven, true), 0.2);
}

TEST(Stability, ModelIsMoreAccurateThanHoldAndInterpolation) {
  const Recording recording = record_carving(4);
  const LineQuality line{.rtt_ms = 25};
  const double model = force_error(recording, ForceMode::kModel, line, false);
  EXPECT_LT(model, 0.15);
  EXPECT_LT(model, 0.6 * force_error(recording, ForceMode::kHold, line, false));
  EXPECT_LT(model, 0.6 * force_error(recording, ForceMode::kInterpolated, line, false));
}

TEST(ShippedScenes, ForceAndTorqueAreFeltAsComputedOnTheReferenceDevice) {
  for (const ShippedScene& scene : shipped_scenes()) {
    const ShippedFeel feel = feel_shipped(scene, 2.5);
    const std::string which = scene.file + ", program " + std::to_string(scene.program);
    EXPECT_LE(feel.server_force.error(), 0.05) << which;
    EXPECT_LE(feel.server_torque.error(), 0.05) << which;
    EXPECT_LE(feel.agent.reduced_ticks, feel.agent.ticks / 4) << which << ": the ramp only";
    EXPECT_EQ(feel.trips, 0U) << which;
    EXPECT_GT(feel.server_force.computed_peak(), 0.1) << which << ": the test requires a force";
  }
}

TEST(ShippedScenes, TheDemoIsFeltAsComputedAroundItsCorners) {
  // Plunges, and arcs of short segments at 55 mm/s, from the seventh second on.
  const ShippedFeel feel = feel_shipped(shipped_scenes().front(), 13);
  EXPECT_LE(feel.server_force.error(), 0.05);
  EXPECT_LE(feel.server_torque.error(), 0.05);
  EXPECT_GT(feel.server_force.computed_peak(), 3) << "the test requires a deep cut";
}

/// Hands with little and much mass, with the greatest latency and none.
TEST(Stability, StockAppearingAroundTheToolIsPassive) {
  for (const std::uint64_t latency_us : {0U, 3000U}) {
    for (const Surrounding by : {Surrounding::kUndo, Surrounding::kLargerTool}) {
      for (const bool cutting : {false, true}) {
        const SurroundOutcome outcome = surround({.mechanics = {.mass_kg = 0.3,
                                                                .inertia_kg_m2 = 2e-4,
                                                                .hand_n_per_mm = 0.2,
                                                                .hand_nmm_per_rad = 134,
                                                                .latency_us = latency_us},
                                                  .line = {.rtt_ms = 50},
                                                  .by = by,
                                                  .cutting = cutting});
        const std::string which = std::to_string(latency_us) + " us, " +
                                  (by == Surrounding::kUndo ? "undo" : "larger tool") +
                                  (cutting ? ", cutting" : "");
        EXPECT_LE(outcome.returned_mj, 5) << which;
        EXPECT_EQ(outcome.trips, 0U) << which;
        EXPECT_GE(outcome.changes, 4) << which << ": the test requires stock around the tool";
      }
    }
  }
}

TEST(Stability, AToolRestsInItsOwnCutWithTheCuttingButtonPressed) {
  for (const double inertia_kg_m2 : {1e-5, 2e-4}) {
    for (const double n_per_mm : {0.02, 0.2}) {
      const SurroundOutcome outcome = surround({.mechanics = {.mass_kg = 0.3,
                                                              .inertia_kg_m2 = inertia_kg_m2,
                                                              .hand_n_per_mm = n_per_mm,
                                                              .hand_nmm_per_rad = 670 * n_per_mm},
                                                .line = {.rtt_ms = 50},
                                                .by = Surrounding::kNothing,
                                                .cutting = true});
      EXPECT_LE(outcome.buzz_mm_per_s, 2) << inertia_kg_m2 << " kg m2, " << n_per_mm << " N/mm";
    }
  }
}

/// Hands that a flat tool shook at 6 to 29 mm/s while its contact was one point, pushed along the
/// normal of the tool.
TEST(Stability, AFlatToolRestsOnAFace) {
  constexpr std::size_t kFlat6 = 0, kFlat12 = 1, kFlat20 = 2, kSlot = 9;
  const FaceRest rests[] = {
      {.mechanics = {1.55, 4.4e-5, 1.181, 493, 0.83, 1000}, .tool = kFlat12, .tilt_rad = 0.24},
      {.mechanics = {0.06, 4.4e-5, 0.334, 303, 0.14, 0}, .tool = kSlot, .depth_mm = 5},
      {.mechanics = {0.07, 2.7e-4, 0.892, 753, 0.23, 3000}, .tool = kFlat20, .tilt_rad = 0.24},
      {.mechanics = {0.08, 4e-5, 1.021, 70, 0.14, 0}, .tool = kFlat6, .depth_mm = 2.2},
      {.mechanics = {1.74, 1.2e-5, 0.334, 541, 0.31, 3000}, .tool = kFlat6, .tilt_rad = 0.02},
      {.mechanics = {0.2, 2e-4, 0.4, 268, 0.5, 1000}, .tool = kFlat6, .tilt_rad = 0.3}};
  for (const FaceRest& rest : rests) {
    const FaceRestOutcome outcome = rest_on_face(rest);
    const std::string which = std::string(kFaceTools[rest.tool].name) + ", " +
                              std::to_string(rest.tilt_rad) + " rad, " +
                              std::to_string(rest.mechanics.mass_kg) + " kg";
    EXPECT_LE(outcome.buzz_mm_per_s, 2) << which;
    EXPECT_LE(outcome.returned_mj, 5) << which;
    EXPECT_EQ(outcome.trips, 0U) << which;
    EXPECT_GT(outcome.force_n, 0.3) << which << ": the test requires a contact";
  }
}

TEST(ShippedScenes, PlungesAreFeltAsComputed) {
  // The force drops from its peak to almost nothing in the tick in which a plunge turns into a cut.
  for (const std::string_view name : {"template:box", "template:cylinder"}) {
    const auto scene = std::ranges::find(shipped_scenes(), name, &ShippedScene::file);
    ASSERT_NE(scene, shipped_scenes().end());
    const ShippedFeel feel = feel_shipped(*scene, 20);
    EXPECT_LE(feel.server_force.error(), 0.04) << name;
    EXPECT_LE(feel.server_torque.error(), 0.04) << name;
    EXPECT_GT(feel.server_force.computed_peak(), 1) << "the test requires plunges";
  }
}

}  // namespace
}  // namespace kerf::agent::stability_test
