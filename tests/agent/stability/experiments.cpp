// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/stability/experiments.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "haptic_agent/device/carving_figure.h"
#include "haptic_agent/device/simulated_hand.h"
#include "tests/agent/stability/bench_hand.h"
#include "tests/agent/stability/plant.h"
#include "tests/agent/stability/test_bed.h"

namespace kerf::agent {
namespace {

/// Time at rest before the motion starts, in which the device arms.
constexpr double kRestS = 0.9;

std::string swing_scene(double damping_n_s_per_m) {
  // A flat end of 10 mm, 2 mm deep, engages 20 mm² at most.
  const double drr = damping_n_s_per_m / 1000 / 20;
  return R"({"name":"swing","stock":{"shape":"box","min_mm":[-30,-20,-10],"max_mm":[30,40,0]},
    "accuracy":{"rays":"dexel","pitch_mm":0.5,"tolerance_mm":0.01,"motion":"tight"},
    "tools":[{"id":1,"shape":"flat","diameter_mm":10,"length_mm":40}],
    "force":{"law":"drr","drr_n_s_per_mm3":)" +
         std::to_string(drr) + R"(,"pivot_mm":60}})";
}

/// A block with its top at z = 0 and a wall at x = 0, as stock, or as an obstacle above the stock.
std::string press_scene(bool obstacle, const std::string& guides) {
  const std::string box = R"("shape":"box","min_mm":[0,-30,-20],"max_mm":[30,30,0])";
  const std::string below = R"("shape":"box","min_mm":[0,-30,-40],"max_mm":[30,30,-39])";
  return R"({"name":"press","stock":{)" + (obstacle || !guides.empty() ? below : box) + R"(},
    "accuracy":{"rays":"dexel","pitch_mm":0.5,"tolerance_mm":0.01,"motion":"tight"},
    "tools":[{"id":1,"shape":"ball","diameter_mm":6,"length_mm":40}],)" +
         (obstacle ? R"("obstacles":[{)" + box + "}]," : std::string()) +
         (guides.empty() ? std::string() : R"("guides":)" + guides + ",") +
         R"("force":{"law":"specific_energy","specific_force_n_per_mm2":0.2,"pivot_mm":60}})";
}

constexpr double kPressS = 0.3;  ///< duration of the approach
constexpr double kHeldS = 1.5;
constexpr int kBuzzTicks = 500;
constexpr double kPressMm = 4;  ///< depth of the hand's target below the surface

/// Approaches from 3 mm outside the surface, stays at kPressMm inside.
Vec3 pressing(const Press& press, double time_s) {
  const double share = std::clamp((time_s - kRestS) / kPressS, 0.0, 1.0);
  const double depth = -3 + (3 + kPressMm) * share;
  return press.sideways ? Vec3{-3 + depth, 0, -10} : Vec3{15, 0, -depth};
}

constexpr const char* kCarvingScene = R"({"name":"carving",
    "stock":{"shape":"box","min_mm":[-30,-30,-20],"max_mm":[30,30,0]},
    "accuracy":{"rays":"dexel","pitch_mm":0.25,"tolerance_mm":0.01,"motion":"tight"},
    "tools":[{"id":1,"shape":"ball","diameter_mm":6,"length_mm":40}],
    "force":{"law":"specific_energy","specific_force_n_per_mm2":0.2,"pivot_mm":20}})";

/// 30 mm at 1 Hz along x, starting next to the block, and slowly along y into uncut stock.
Vec3 swinging(double time_s) {
  const double t = std::max(0.0, time_s - kRestS);
  const double x = -38 + 30 * (1 - std::cos(2 * std::numbers::pi * t));
  return {x, -15 + 6 * t, -2};
}

/// A simulated hand whose poses are recorded.
class Recorder final : public HapticDevice {
 public:
  Recorder(SimulatedHand& hand, std::vector<DeviceState>& poses) : hand_(hand), poses_(poses) {}
  DeviceCapabilities capabilities() const override { return hand_.capabilities(); }
  DeviceState read(std::uint64_t now_us) noexcept override {
    poses_.push_back(hand_.read(now_us));
    return poses_.back();
  }
  /// Ignores the wrench, so that the recorded path does not depend on it.
  void write(const Wrench&) noexcept override {}
  void stop() noexcept override {}

 private:
  SimulatedHand& hand_;
  std::vector<DeviceState>& poses_;
};

/// Force of the server's newest answer, before transmission.
Vec3 felt(const TestBed& bed) { return Vec3(bed.newest().force_n); }

}  // namespace

SwingOutcome swing(const Swing& swing) {
  BenchHand hand(swinging, {});
  TestBed bed(swing_scene(swing.damping_n_s_per_m), hand, {.mode = swing.mode}, swing.line,
              swing.copy);
  SwingOutcome outcome;
  const int ticks = static_cast<int>((swing.seconds + kRestS) * 1000);
  for (int i = 0; i < ticks; ++i) bed.tick();
  const ServoCycle& servo = bed.servo();
  outcome.fastest_mm_per_s = hand.fastest();
  outcome.returned_mj = servo.passivity().account().most_returned_mj();
  outcome.max_force_n = servo.report().max_force_n;
  outcome.active = servo.supervisor().phase() >= ServoPhase::kRamp;
  outcome.trips = servo.supervisor().trips();
  return outcome;
}

PressOutcome press(const Press& press) {
  Plant plant([&](double time_s) { return pressing(press, time_s); }, press.mechanics, false);
  if (press.ignores_latency) plant.declare_latency(0);
  if (press.ignores_inertia) plant.declare_inertia(1);
  TestBed bed(press_scene(press.obstacle, press.guides), plant, {}, press.line, true);
  const int ticks = static_cast<int>((kRestS + kPressS + kHeldS) * 1000);
  double most_n = 0;
  for (int i = 0; i < ticks; ++i) {
    if (i == ticks - kBuzzTicks) plant.begin_rest();
    bed.tick(!press.loses_ticks || i % 200 >= 4);
    most_n = std::max(most_n, length(plant.acting().force_n));
  }
  return {.returned_mj = plant.most_returned_mj(),
          .buzz_mm_per_s = plant.rms_mm_per_s(),
          .force_n = length(plant.acting().force_n),
          .most_force_n = most_n,
          .trips = bed.servo().supervisor().trips()};
}

Recording record_carving(double seconds) {
  Recording recording;
  const StockBox stock{{-30, -30, -20}, {30, 30, 0}};
  SimulatedHand hand(PathCursor(make_carving_figure(stock, 1), false),
                     {.pivot_mm = 20, .rest_at_start_s = kRestS});
  Recorder recorder(hand, recording.poses);
  TestBed bed(kCarvingScene, recorder, {.mode = ForceMode::kInterpolated}, {}, false);
  for (int i = 0; i < static_cast<int>(seconds * 1000); ++i) {
    bed.tick();
    recording.force_n.push_back(felt(bed));
  }
  return recording;
}

Recording beside_another(const Recording& alone, double ahead_s, double beside_mm) {
  const double along_mm = beside_mm / std::numbers::sqrt2;
  Recording recording{.poses = alone.poses, .force_n = {}, .another = {}};
  const auto ahead = static_cast<std::size_t>(ahead_s * 1000);
  for (std::size_t i = 0; i < alone.poses.size(); ++i) {
    const DeviceState& pose = alone.poses[std::min(i + ahead, alone.poses.size() - 1)];
    recording.another.push_back(pose.tip_mm + Vec3{along_mm, along_mm, 0});
  }
  RecordedHand hand(recording.poses);
  TestBed bed(kCarvingScene, hand, {.mode = ForceMode::kInterpolated}, {}, false);
  for (const Vec3& tip : recording.another) {
    bed.another_cuts_to(tip);
    bed.tick();
    recording.force_n.push_back(felt(bed));
  }
  return recording;
}

double carved_volume_mm3(const Recording& recording, const std::string& guides) {
  RecordedHand hand(recording.poses);
  std::string scene = kCarvingScene;
  if (!guides.empty()) scene.insert(scene.size() - 1, R"(,"guides":)" + guides);
  TestBed bed(scene, hand, {}, {}, true);
  for (std::size_t i = 0; i < recording.poses.size(); ++i) bed.tick();
  if (!guides.empty() && bed.guidance()->uses().front().ticks == 0)
    throw std::runtime_error("the guide was not felt");
  return bed.session().info().removed_mm3;
}

double force_error(const Recording& recording, ForceMode mode, const LineQuality& line, bool copy,
                   bool intent) {
  RecordedHand hand(recording.poses);
  TestBed bed(kCarvingScene, hand, {.mode = mode}, line, copy, 1, intent);
  double error2 = 0, force2 = 0;
  for (std::size_t i = 0; i < recording.poses.size(); ++i) {
    if (!recording.another.empty()) bed.another_cuts_to(recording.another[i]);
    bed.tick();
    // Skips the time before the force has ramped up.
    if (i < static_cast<std::size_t>(kRestS * 1000) + 800) continue;
    const Vec3 difference = hand.output.force_n - recording.force_n[i];
    error2 += dot(difference, difference);
    force2 += dot(recording.force_n[i], recording.force_n[i]);
  }
  return force2 > 0 ? std::sqrt(error2 / force2) : 0;
}

}  // namespace kerf::agent
