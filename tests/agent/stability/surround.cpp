// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/stability/surround.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/agent/stability/test_bed.h"

namespace kerf::agent {
namespace {

std::string scene_of(const Surround& surround) {
  const std::string shape = surround.flat ? R"("flat")" : R"("ball")";
  return R"({"name":"surround","stock":{"shape":"box","min_mm":[0,-20,-20],"max_mm":[40,20,0]},
    "accuracy":{"rays":"dexel","pitch_mm":0.5,"tolerance_mm":0.01,"motion":"tight"},
    "tools":[{"id":1,"diameter_mm":6,"length_mm":40,"shape":)" +
         shape + R"(},{"id":2,"diameter_mm":10,"length_mm":40,"shape":)" + shape +
         R"(}],"force":{"law":"specific_energy","pivot_mm":60,"specific_force_n_per_mm2":)" +
         std::to_string(surround.force_n_per_mm2) + "}}";
}

/// Durations: at rest before the slot, in which the device arms; of the slot; in it, until the
/// changes begin; of the motion to and fro; and at rest, with changes in its first half.
constexpr double kRestS = 0.9, kSlotS = 1.2, kPauseS = 0.3, kHeldS = 1.2;
constexpr double kChangesFromS = kRestS + kSlotS + kPauseS;
constexpr int kChangeTicks = 400, kPressedTicks = 50, kBuzzTicks = 500;
constexpr double kStartMm = -6, kEndMm = 18, kDepthMm = 3;

Vec3 target(const Surround& surround, double time_s) {
  const double slot = std::clamp((time_s - kRestS) / kSlotS, 0.0, 1.0);
  const double swing = std::clamp((time_s - kChangesFromS) / surround.swing_s, 0.0, 1.0);
  const double aside = surround.swing_mm * std::sin(4 * std::numbers::pi * swing);
  return {kStartMm + (kEndMm - kStartMm) * slot + aside, 0, -kDepthMm};
}

/// The hand's buttons and tool. Counts how often they changed the stock around the tool.
class Changes {
 public:
  explicit Changes(const Surround& surround) : surround_(surround) {}

  /// `since`: ticks since the first change; negative before it.
  void press(Plant& plant, int since, bool on) {
    std::uint32_t buttons = surround_.cutting || since < 0 ? wire::kButtonCutting : 0U;
    const bool first = since / kChangeTicks % 2 == 0;
    if (on && surround_.by == Surrounding::kUndo && since % kChangeTicks < kPressedTicks)
      buttons |= first ? kButtonUndo : kButtonRedo;
    if (on && surround_.by == Surrounding::kLargerTool) {
      count_ += tool_id_ != (first ? 2U : 1U) ? 1 : 0;
      tool_id_ = first ? 2 : 1;
    }
    plant.hold(buttons, tool_id_);
  }
  /// Records the volume that the session has removed.
  void take(double removed_mm3) {
    constexpr double kStrokeMm3 = 20;  // a tick removes far less
    if (std::abs(removed_mm3 - removed_mm3_) > kStrokeMm3) ++count_;
    removed_mm3_ = removed_mm3;
  }
  int count() const { return count_; }

 private:
  const Surround& surround_;
  std::uint32_t tool_id_ = 1;
  double removed_mm3_ = 0;
  int count_ = 0;
};

}  // namespace

SurroundOutcome surround(const Surround& surround) {
  Plant plant([&](double time_s) { return target(surround, time_s); }, surround.mechanics, true);
  TestBed bed(scene_of(surround), plant, {}, surround.line, true);
  constexpr int kFirst = static_cast<int>(kChangesFromS * 1000);
  const int ticks = static_cast<int>((kChangesFromS + surround.swing_s + kHeldS) * 1000);
  Changes changes(surround);
  SurroundOutcome outcome;
  for (int i = 0; i < ticks; ++i) {
    const bool on = i >= kFirst && i < ticks - 2 * kBuzzTicks;
    changes.press(plant, i - kFirst, on);
    if (i == ticks - kBuzzTicks) plant.begin_rest();
    bed.tick(!surround.loses_ticks || i % 200 >= 4);
    changes.take(bed.session().info().removed_mm3);
    if (on) outcome.most_force_n = std::max(outcome.most_force_n, length(plant.acting().force_n));
  }
  outcome.changes = changes.count();
  outcome.returned_mj = plant.most_returned_mj();
  outcome.buzz_mm_per_s = plant.rms_mm_per_s();
  outcome.moved_at_rest_mm = plant.moved_at_rest_mm();
  outcome.given_at_rest_mj = plant.given_at_rest_mj();
  outcome.trips = bed.servo().supervisor().trips();
  return outcome;
}

}  // namespace kerf::agent
