// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/servo/flight_recorder.h"
#include "haptic_agent/servo/hold_history.h"
#include "haptic_agent/servo/latest_value.h"
#include "haptic_agent/servo/local_model.h"
#include "haptic_agent/servo/near_answers.h"
#include "haptic_agent/servo/output_stage.h"
#include "haptic_agent/servo/sample_ring.h"
#include "haptic_agent/servo/servo_loop.h"
#include "haptic_agent/servo/supervisor.h"
#include "haptic_agent/servo/velocity_estimator.h"
#include "haptic_agent/servo/wrench_interpolator.h"

namespace kerf::agent {

/// Told after each sample that there is something to send; must not wait.
class SampleListener {
 public:
  virtual ~SampleListener() = default;
  virtual void sample_ready() noexcept = 0;
};

/// What a tick makes of the server's answers.
enum class ForceMode : std::uint8_t {
  /// The local model, driven by the hand's own motion: right at any delay.
  kModel,
  /// The paper's: the straight line from the wrench before to the newest.
  kInterpolated,
  /// The newest wrench until the next.
  kHold,
};

struct ServoSettings {
  WrenchLimits limits{};
  /// The tool of samples whose device asks for none.
  std::uint32_t tool_id = 1;
  /// Ends the loop after this time; 0: never.
  std::uint64_t duration_us = 0;
  ForceMode mode = ForceMode::kModel;
  ModelSettings model{};
  PassivitySettings passivity{};
  SafetyLimits safety{.motors = false};
  /// Distance of the pivot from the tip along the axis, mm.
  double pivot_mm = 60;
  /// Of the velocity estimate; belongs to the device.
  double velocity_cutoff_hz = 100;
};

/// The settings that suit a device: what it shows stably, its ratings, its workspace.
ServoSettings settings_for(const DeviceCapabilities& device, ServoSettings settings);

/// What the cycle has seen; read it when the loop has ended.
struct ServoReport {
  std::uint64_t samples = 0;
  /// The link was a whole ring behind, and the sample was dropped.
  std::uint64_t ring_overflows = 0;
  /// Who answers from near by was a whole ring behind.
  std::uint64_t near_overflows = 0;
  /// Ticks that had a new answer from near by.
  std::uint64_t near_answers = 0;
  /// The device had no pose, or none that was finite.
  std::uint64_t invalid_poses = 0;
  /// Ticks in which an answer was too old to be shown in full.
  std::uint64_t decayed_ticks = 0;
  double max_force_n = 0;
  double max_torque_nmm = 0;
};

/// The newest tick, for whoever wants to look on.
struct ServoStatus {
  ServoPhase phase = ServoPhase::kReady;
  TripCode code = TripCode::kNone;
  std::uint64_t trips = 0;
  Wrench shown{};
  double energy_mj = 0;
  double speed_mm_per_s = 0;
  std::uint64_t answer_age_us = 0;
};

/// One tick: read the device, hand the pose to the link, and show what the newest answer means here
/// and now: faded when the server falls silent, released by the supervisor, made passive, limited.
/// No allocation, lock, exception or output.
class ServoCycle final : public ServoTask {
 public:
  /// All references must outlive the cycle, and so must whoever answers from near by; null: nobody.
  ServoCycle(HapticDevice& device, SampleRing& samples, LatestValue<ServerWrench>& wrenches,
             SampleListener& listener, const ServoSettings& settings,
             NearAnswers* near = nullptr) noexcept;

  bool tick(std::uint64_t now_us) noexcept override;

  const ServoReport& report() const noexcept { return report_; }
  const WrenchLimiter& limiter() const noexcept { return output_.limiter(); }
  const Passivity& passivity() const noexcept { return output_.passivity(); }
  const Supervisor& supervisor() const noexcept { return supervisor_; }
  /// For one other thread each.
  LatestValue<ServoStatus>& status() noexcept { return status_; }
  FlightRecorder& recorder() noexcept { return recorder_; }

 private:
  bool send(const DeviceState& state) noexcept;
  Twist follow(const DeviceState& state, bool usable, std::uint64_t now_us, double dt_s) noexcept;
  void take_answers(std::uint64_t now_us) noexcept;
  Wrench wanted(std::uint64_t now_us, bool cutting, double dt_s) noexcept;
  std::uint64_t answer_age(std::uint64_t now_us) const noexcept;
  SafetyInput look(const DeviceState& state, bool usable, const Wrench& wanted) const noexcept;
  void note(const SafetyInput& seen, const Wrench& wanted) noexcept;

  HapticDevice& device_;
  SampleRing& samples_;
  LatestValue<ServerWrench>& wrenches_;
  SampleListener& listener_;
  NearAnswers* near_;
  ServoSettings settings_;
  WrenchInterpolator interpolator_;
  LocalModel model_;
  HoldHistory history_;
  VelocityEstimator velocity_;
  OutputStage output_;
  Supervisor supervisor_;
  FlightRecorder recorder_;
  LatestValue<ServoStatus> status_;
  ServoReport report_;
  PastHold now_;
  /// The felt wrench of the newest answer, smoothed.
  Wrench felt_{};
  Vec3 tip_mm_{};
  double jumped_mm_ = 0;
  bool has_hold_ = false;
  bool has_answer_ = false;
  /// When somebody near by has answered last; 0: never.
  std::uint64_t near_us_ = 0;
  std::uint64_t lost_now_ = 0;
  std::uint64_t noted_trips_ = 0;
  std::uint64_t start_us_ = 0;
  std::uint64_t last_us_ = 0;
};

}  // namespace kerf::agent
