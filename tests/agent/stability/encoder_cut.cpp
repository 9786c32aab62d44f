// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/stability/encoder_cut.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "haptic_agent/device/falcon/falcon_kinematics.h"
#include "tests/agent/stability/plant.h"
#include "tests/agent/stability/test_bed.h"

namespace kerf::agent {
namespace {

/// Time at rest before the motion, in which the device arms and the force rises.
constexpr double kRestS = 1.2;
/// Travel after which a cut in one field is even, two pitches, and travel that is measured.
constexpr double kLeadMm = 1, kMeasuredMm = 1.5;
constexpr double kAboveMm = 0.3;
constexpr double kLeanRad = 0.3;

std::string force_of(std::string_view law) {
  if (law == "drr") return R"("law":"drr","drr_n_s_per_mm3":0.0008)";
  if (law == "mechanistic") {
    return R"("law":"mechanistic","material":"aluminium-6061","spindle_rpm":12000,"teeth":2,"scale":0.03)";
  }
  return R"("law":"specific_energy","specific_force_n_per_mm2":0.08)";
}

std::string scene_of(const EncoderCut& cut) {
  return R"({"name":"encoders","stock":{"shape":"box","min_mm":[-12,-12,-12],"max_mm":[12,12,0]},
    "accuracy":{"rays":")" +
         std::string(cut.rays) + R"(","pitch_mm":0.2,"tolerance_mm":0.005,"motion":"tight"},
    "tools":[{"id":1,"shape":"flat","diameter_mm":6,"length_mm":40}],
    "force":{"pivot_mm":60,)" +
         force_of(cut.law) + "}}";
}

struct Line {
  Vec3 from_mm, along, axis{0, 0, 1};
};
Line line_of(StraightCut path) {
  // Off the encoders' grid, so that no two coordinates step together by chance.
  constexpr Vec3 kOff{0.0131, -0.0077, 0.0043};
  switch (path) {
    case StraightCut::kPlunge:
      return {kOff + Vec3{0, 0, kAboveMm}, {0, 0, -1}};
    case StraightCut::kSlot:
      return {kOff + Vec3{-4, 0, -2}, {1, 0, 0}};
    case StraightCut::kRamp:
      return {kOff + Vec3{-4, 0, -2}, normalized(Vec3{3, 0, -1})};
    case StraightCut::kTilted:
      break;
  }
  const Vec3 axis{std::sin(kLeanRad), 0, std::cos(kLeanRad)};
  return {kOff + Vec3{-4, -2, -2}, normalized(Vec3{2, 1, 0}), axis};
}

/// Returns the tip as the driver of a Falcon reports it, from the counts of its legs' encoders.
Vec3 by_falcon(Vec3 tip_mm, falcon::LegTracker& legs) {
  const Vec3 position = falcon::from_kerf(tip_mm) + falcon::kMiddleMm;
  const falcon::LegAngles exact = falcon::leg_angles(position).value();
  std::array<std::int16_t, 3> counts{};
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = falcon::count_of(exact[i]);
  constexpr double kTickS = 0.001;
  const falcon::LegAngles angles = legs.take(counts, kTickS);
  return falcon::to_kerf(falcon::position_of(angles, position).value() - falcon::kMiddleMm);
}

/// A device on a straight path whose encoders round its pose.
class RoundingDevice final : public HapticDevice {
 public:
  explicit RoundingDevice(const EncoderCut& cut) : cut_(cut), line_(line_of(cut.path)) {}
  DeviceCapabilities capabilities() const override {
    return {.name = "rounding device",
            .sensed_dof = 5,
            .actuated_dof = 5,
            .max_force_n = 20,
            .max_torque_nmm = 500,
            .max_stiffness_n_per_mm = 3,
            .max_damping_n_s_per_mm = 0.06,
            .resolution_mm = cut_.falcon     ? 0.001
                             : cut_.declared ? cut_.quantum_mm
                                             : 0,
            .resolution_rad = cut_.declared ? cut_.quantum_rad : 0,
            .moving_mass_kg = 0.3,
            .moving_inertia_kg_m2 = 2e-3};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    if (start_us_ == 0) start_us_ = now_us;
    const double time_s = static_cast<double>(now_us - start_us_) * 1e-6;
    path_mm = std::max(0.0, time_s - kRestS) * cut_.mm_per_s;
    const Vec3 tip_mm = line_.from_mm + line_.along * path_mm;
    return {.tip_mm = cut_.falcon ? by_falcon(tip_mm, legs_) : rounded(tip_mm, cut_.quantum_mm),
            .axis = normalized(rounded(line_.axis, cut_.quantum_rad)),
            .buttons = wire::kButtonDeadman | wire::kButtonCutting,
            .time_us = now_us,
            .valid = true,
            .phase = DevicePhase::kReady};
  }
  void write(const Wrench& wrench) noexcept override { output = wrench; }
  void stop() noexcept override { output = {}; }

  double path_mm = 0;
  Wrench output;

 private:
  EncoderCut cut_;
  Line line_;
  falcon::LegTracker legs_;
  std::uint64_t start_us_ = 0;
};

}  // namespace

const char* name_of(StraightCut cut) noexcept {
  constexpr const char* kNames[] = {"plunge", "slot", "ramp", "tilted"};
  return kNames[static_cast<int>(cut)];
}

EncoderCutOutcome cut_by_encoder(const EncoderCut& cut) {
  EncoderCut exact = cut;
  exact.quantum_mm = exact.quantum_rad = 0;
  exact.falcon = false;
  RoundingDevice device(cut), ideal(exact);
  TestBed bed(scene_of(cut), device, {}, {}, true);
  TestBed each(scene_of(cut), ideal, {}, {}, true);
  const double settle_mm = std::max(2 * cut.quantum_mm, 0.01 * cut.mm_per_s);
  const double first_mm = (cut.path == StraightCut::kPlunge ? kAboveMm : 0) + kLeadMm + settle_mm;
  const double measured_mm = std::max(kMeasuredMm, 0.05 * cut.mm_per_s);
  EncoderCutOutcome outcome;
  while (ideal.path_mm < first_mm + measured_mm) {
    bed.tick();
    each.tick();
    if (ideal.path_mm < first_mm) continue;
    outcome.force.add(device.output.force_n, ideal.output.force_n);
    outcome.torque.add(device.output.torque_nmm, ideal.output.torque_nmm);
  }
  outcome.removed_share = bed.session().info().removed_mm3 / each.session().info().removed_mm3;
  return outcome;
}

}  // namespace kerf::agent
