// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/stability/held_cut.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/agent/stability/test_bed.h"

namespace kerf::agent {
namespace {

/// Time at rest before the motion, in which the device arms, and time in the block until the ramp
/// is over.
constexpr double kRestS = 0.9;
constexpr double kRampS = 0.8;
constexpr double kLeadMm = 15, kDepthMm = 2;

/// The section of the slot: a segment of the ball, mm².
double section_mm2() {
  const double r = 3, h = kDepthMm;
  return r * r * std::acos((r - h) / r) - (r - h) * std::sqrt(2 * r * h - h * h);
}

/// A slot of 1 N at `scale` 1: 0.05 mm per tooth at 20 mm/s.
constexpr double kMillingScale = 0.028;

std::string force_of(const HandHeldCut& cut) {
  if (cut.mechanistic) {
    return R"("law":"mechanistic","material":"aluminium-6061","spindle_rpm":12000,"teeth":2,"scale":)" +
           std::to_string(kMillingScale * cut.newtons);
  }
  return R"("law":"specific_energy","specific_force_n_per_mm2":)" +
         std::to_string(cut.newtons / section_mm2());
}

std::string scene_of(const HandHeldCut& cut) {
  return R"({"name":"held","stock":{"shape":"box","min_mm":[-15,-20,-10],"max_mm":[40,75,0]},
    "accuracy":{"rays":"dexel","pitch_mm":0.25,"tolerance_mm":0.01,"motion":"tight"},
    "tools":[{"id":1,"shape":"ball","diameter_mm":6,"length_mm":40}],
    "force":{"pivot_mm":60,)" +
         force_of(cut) + "}}";
}

Vec3 target(const HandHeldCut& cut, double time_s) {
  const double path_mm = std::max(0.0, time_s - kRestS) * cut.mm_per_s - 8;
  if (path_mm < kLeadMm) return {path_mm - 15, 0, -kDepthMm};
  const double angle = (path_mm - kLeadMm) / cut.radius_mm;
  return {cut.radius_mm * std::sin(angle), cut.radius_mm * (1 - std::cos(angle)), -kDepthMm};
}

/// Passes the poses of a plant to a second agent.
class Mirror final : public HapticDevice {
 public:
  explicit Mirror(const DeviceCapabilities& device) : device_(device) {}
  DeviceCapabilities capabilities() const override { return device_; }
  DeviceState read(std::uint64_t) noexcept override { return state; }
  void write(const Wrench&) noexcept override {}
  void stop() noexcept override {}

  DeviceState state;

 private:
  DeviceCapabilities device_;
};

}  // namespace

HeldCutOutcome cut_by_hand(const HandHeldCut& cut) {
  Plant plant([&](double time_s) { return target(cut, time_s); }, cut.mechanics, true);
  Mirror mirror(plant.capabilities());
  TestBed bed(scene_of(cut), plant, {}, cut.line, true);
  // Without a replica each sample is sent alone, so each answer of the server is for one sample.
  TestBed each(scene_of(cut), mirror, {}, {}, false);
  HeldCutOutcome outcome;
  const double end_s = kRestS + (8 + kLeadMm + std::numbers::pi * cut.radius_mm) / cut.mm_per_s;
  double square = 0;
  int ticks = 0;
  Vec3 before = plant.tip();
  for (int i = 0; i < static_cast<int>(end_s * 1000); ++i) {
    const double time_s = i * 0.001;
    bed.tick();
    mirror.state = plant.read(bed.now_us());
    each.tick();
    const Vec3 moved = (plant.tip() - before) * 1000;
    before = plant.tip();
    const Vec3 force(each.newest().force_n), torque(each.newest().torque_nmm);
    if (time_s < kRestS + kRampS) continue;
    const Vec3 wanted = (target(cut, time_s) - target(cut, time_s - 0.001)) * 1000;
    square += dot(moved - wanted, moved - wanted);
    ++ticks;
    outcome.force.add(plant.acting().force_n, force);
    outcome.torque.add(plant.acting().torque_nmm, torque);
  }
  outcome.chatter_mm_per_s = std::sqrt(square / ticks);
  outcome.returned_mj = plant.most_returned_mj();
  outcome.trips = bed.servo().supervisor().trips();
  return outcome;
}

}  // namespace kerf::agent
