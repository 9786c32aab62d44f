// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/stability/stroke_cut.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "haptic_agent/device/reference/reference_protocol.h"
#include "tests/agent/stability/test_bed.h"

namespace kerf::agent {
namespace {

/// Time at rest before the stroke, in which the device arms and the force rises.
constexpr double kRestS = 1.2;
constexpr double kAboveMm = 1;
constexpr double kTurn = 2 * std::numbers::pi;

/// Returns the tip at a time after the start of the stroke, relative to the middle of the block's
/// top.
Vec3 offset_at(Stroke stroke, double rate, double t) {
  const double phase = kTurn * rate * t;
  switch (stroke) {
    case Stroke::kPecking:
      return {2 * t, 0, kAboveMm - 1.5 * (1 - std::cos(phase))};
    case Stroke::kStippling: {
      // The tool moves to the side while it is above the block.
      const double x = 2 * (rate * t - std::sin(phase) / kTurn);
      return {x, 0, kAboveMm - 0.75 * (1 - std::cos(phase))};
    }
    case Stroke::kHatching: {
      const double down = std::min(2.0, 10 * t);
      return {4 * std::sin(phase), 3 * t, kAboveMm - down};
    }
    case Stroke::kTrochoidal: {
      const double down = std::min(2.0, 10 * t);
      return {2 * std::cos(phase) + 3 * t, 2 * std::sin(phase), kAboveMm - down};
    }
    case Stroke::kDrilling:
      return {0, 0, kAboveMm - std::min(4.0, rate * t)};
    case Stroke::kSlotting: {
      const double lead_s = 2 / rate;
      if (t < lead_s) return {0, 0, kAboveMm - rate * t};
      return {std::min(8.0, rate * (t - lead_s)), 0, kAboveMm - 2};
    }
  }
  return {};
}

Vec3 axis_of(const StrokeCut& cut) { return {std::sin(cut.tilt_rad), 0, std::cos(cut.tilt_rad)}; }

/// Returns the tip at a time. A drill moves along its axis.
Vec3 tip_at(const StrokeCut& cut, double time_s) {
  const Vec3 at = offset_at(cut.stroke, cut.rate, std::max(0.0, time_s - kRestS));
  if (cut.stroke != Stroke::kDrilling) return at + Vec3{-5, -4, 0};
  return axis_of(cut) * at.z + Vec3{0, 0, 1 - axis_of(cut).z};
}

/// Greatest area that a plunge of each tool engages, mm²; slots engage less.
constexpr double kAreaMm2[] = {22, 28, 28, 8, 7, 28, 3, 3, 30, 12};

std::string scene_of(const StrokeCut& cut) {
  return R"({"name":"stroke","stock":{"shape":"box","min_mm":[-20,-20,-15],"max_mm":[20,20,0]},
    "accuracy":{"rays":")" +
         std::string(cut.rays) + R"(","pitch_mm":0.2,"tolerance_mm":0.005,"motion":"tight"},
    "tools":[{"id":1,)" +
         kStrokeTools[cut.tool] +
         R"(}],"force":{"law":"specific_energy","pivot_mm":60,"specific_force_n_per_mm2":)" +
         std::to_string(cut.newtons / kAreaMm2[cut.tool]) + "}}";
}

/// The reference device in a rigid hand, or the mirror of a live hand's device.
class Shown final : public HapticDevice {
 public:
  explicit Shown(double quantum_mm) : quantum_mm_(quantum_mm) {}
  DeviceCapabilities capabilities() const override {
    DeviceCapabilities device = reference::pen_capabilities({});
    device.workspace_min_mm = device.workspace_max_mm = {};  // the strokes may leave it
    device.resolution_mm = quantum_mm_;
    return device;
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    state.time_us = now_us;
    return state;
  }
  void write(const Wrench& wrench) noexcept override { output = wrench; }
  void stop() noexcept override { output = {}; }
  void show(Vec3 tip_mm, Vec3 axis) {
    state = {.tip_mm = rounded(tip_mm, quantum_mm_),
             .axis = axis,
             .buttons = wire::kButtonDeadman | wire::kButtonCutting,
             .valid = true,
             .phase = DevicePhase::kReady};
  }

  DeviceState state;
  Wrench output;

 private:
  double quantum_mm_;
};

void add(StrokeOutcome& outcome, const Wrench& shown, const Wrench& computed, const Wrench& late) {
  outcome.force.add(shown.force_n, computed.force_n);
  outcome.torque.add(shown.torque_nmm, computed.torque_nmm);
  outcome.late_force.add(late.force_n, computed.force_n);
  outcome.late_torque.add(late.torque_nmm, computed.torque_nmm);
}

PlantMechanics mechanics_of(const StrokeCut& cut) {
  PlantMechanics mechanics = cut.live.value_or(PlantMechanics{});
  mechanics.axis = axis_of(cut);
  return mechanics;
}

}  // namespace

const char* name_of(Stroke stroke) noexcept {
  constexpr const char* kNames[] = {"pecking",    "stippling", "hatching",
                                    "trochoidal", "drilling",  "slotting"};
  return kNames[static_cast<int>(stroke)];
}

std::span<const double> rates_of(Stroke stroke) noexcept {
  static constexpr double kHz[] = {0.5, 1, 2, 3, 5}, kMmPerS[] = {1, 5, 10, 20, 40};
  return stroke < Stroke::kDrilling ? kHz : kMmPerS;
}

StrokeOutcome cut_stroke(const StrokeCut& cut) {
  Plant plant([&](double time_s) { return tip_at(cut, time_s); }, mechanics_of(cut), true);
  Shown stiff(cut.quantum_mm), mirror(0);
  HapticDevice& device = cut.live ? static_cast<HapticDevice&>(plant) : stiff;
  stiff.show(tip_at(cut, 0), axis_of(cut));
  mirror.show(tip_at(cut, 0), axis_of(cut));
  TestBed bed(scene_of(cut), device, {}, {}, true);
  // Without a replica each sample is sent alone, so each answer of the server is for one sample.
  TestBed each(scene_of(cut), mirror, {}, {}, false);
  StrokeOutcome outcome;
  Wrench before;
  const int ticks = static_cast<int>((kRestS + cut.seconds) * 1000);
  for (int i = 0; i < ticks; ++i) {
    const double time_s = i * 0.001;
    if (!cut.live) stiff.show(tip_at(cut, time_s), axis_of(cut));
    bed.tick();
    mirror.show(cut.live ? plant.tip() : tip_at(cut, time_s),
                cut.live ? plant.axis() : axis_of(cut));
    each.tick();
    const Wrench computed{Vec3(each.newest().force_n), Vec3(each.newest().torque_nmm)};
    const Wrench late = std::exchange(before, computed);
    if (time_s < kRestS) continue;
    add(outcome, cut.live ? plant.acting() : stiff.output, computed, late);
  }
  const ServoReport& report = bed.servo().report();
  outcome.soft_share = static_cast<double>(report.soft_ticks) / ticks;
  outcome.reduced_share = report.felt.ticks > 0 ? static_cast<double>(report.felt.reduced_ticks) /
                                                      static_cast<double>(report.felt.ticks)
                                                : 0;
  outcome.returned_mj = plant.most_returned_mj();
  outcome.trips = bed.servo().supervisor().trips();
  return outcome;
}

}  // namespace kerf::agent
