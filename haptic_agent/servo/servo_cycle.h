// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/realtime/latest_value.h"
#include "haptic_agent/servo/felt.h"
#include "haptic_agent/servo/flight_recorder.h"
#include "haptic_agent/servo/force_mode.h"
#include "haptic_agent/servo/grip_history.h"
#include "haptic_agent/servo/guidance.h"
#include "haptic_agent/servo/heard_cut.h"
#include "haptic_agent/servo/local_model.h"
#include "haptic_agent/servo/output_stage.h"
#include "haptic_agent/servo/paper_loop.h"
#include "haptic_agent/servo/replica_exchange.h"
#include "haptic_agent/servo/sample_ring.h"
#include "haptic_agent/servo/servo_loop.h"
#include "haptic_agent/servo/supervisor.h"
#include "haptic_agent/servo/tick_tape.h"
#include "haptic_agent/servo/velocity_estimator.h"
#include "haptic_agent/servo/wrench_interpolator.h"

namespace kerf::agent {

/// Notified after each sample; must not wait.
class SampleListener {
 public:
  virtual ~SampleListener() = default;
  virtual void sample_ready() noexcept = 0;
};

struct ServoSettings {
  WrenchLimits limits{};
  /// Tool of samples for which the device requests none.
  std::uint32_t tool_id = 1;
  /// Ends the loop after this time; 0: never.
  std::uint64_t duration_us = 0;
  ForceMode mode = ForceMode::kModel;
  ModelSettings model{};
  PassivitySettings passivity{};
  SafetyLimits safety{.motors = false};
  /// Distance of the pivot from the tip along the axis, mm.
  double pivot_mm = 60;
  /// Cut-off frequency of the velocity estimate; depends on the device.
  double velocity_cutoff_hz = 100;
};

/// Returns `settings` adapted to a device: stable stiffness and damping, ratings, workspace.
ServoSettings settings_for(const DeviceCapabilities& device, ServoSettings settings);

/// Counters of the cycle; read after the loop has ended.
struct ServoReport {
  std::uint64_t samples = 0;
  /// Samples dropped because the ring to the link was full.
  std::uint64_t ring_overflows = 0;
  /// Samples dropped because the ring to the replica was full.
  std::uint64_t replica_overflows = 0;
  /// Ticks with a new answer of the replica.
  std::uint64_t replica_answers = 0;
  /// Ticks in which the device had no pose or an invalid one.
  std::uint64_t invalid_poses = 0;
  /// Ticks in which the wrench was faded because the answer was too old.
  std::uint64_t decayed_ticks = 0;
  double max_force_n = 0;
  double max_torque_nmm = 0;
  FeltReport felt{};
  /// Ticks with a cut whose force followed the tip by more than kSoftMmPerN, because it shook the
  /// tool (CutCoupling), and the softest.
  std::uint64_t soft_ticks = 0;
  double softest_mm_per_n = 0;

  static constexpr double kSoftMmPerN = 0.1;
};

/// State of the newest tick, for the terminal view.
struct ServoStatus {
  ServoPhase phase = ServoPhase::kReady;
  TripCode code = TripCode::kNone;
  std::uint64_t trips = 0;
  Wrench output{};
  Wrench computed{};
  double energy_mj = 0;
  double speed_mm_per_s = 0;
  std::uint64_t answer_age_us = 0;
  /// Share of the computed wrench that is output.
  double felt_share = 1;
};

/// Samples that the link sends together while the replica answers, and how old, us, its answer may
/// be. The server's copy of the path is late by as many ticks.
inline constexpr int kSamplesPerWake = 8;
inline constexpr std::uint64_t kReplicaFreshUs = 5'000;

/// One tick: reads the device, passes the pose to the link and the replica, and renders the newest
/// answer for the current pose: faded when the server is silent, scaled by the supervisor, made
/// passive, limited. No allocation, lock, exception or printing.
class ServoCycle final : public ServoTask {
 public:
  /// All references, `replica` and `guidance` must outlive the cycle. The last two may be null.
  ServoCycle(HapticDevice& device, SampleRing& samples, LatestValue<ServerWrench>& wrenches,
             SampleListener& listener, const ServoSettings& settings,
             ReplicaExchange* replica = nullptr, Guidance* guidance = nullptr) noexcept;

  bool tick(std::uint64_t now_us) noexcept override;

  /// Every tick goes to `tape` from now on, which must outlive the cycle; at most kTapes of them.
  /// Call before the loop runs.
  static constexpr std::size_t kTapes = 2;
  void record_on(TickTape& tape) noexcept;
  /// Renders in this mode from the next tick on. From any thread.
  void set_mode(ForceMode mode) noexcept { mode_.store(mode, std::memory_order_relaxed); }

  const ServoReport& report() const noexcept { return report_; }
  const WrenchLimiter& limiter() const noexcept { return output_.limiter(); }
  const Passivity& passivity() const noexcept { return output_.passivity(); }
  const Supervisor& supervisor() const noexcept { return supervisor_; }
  /// Each for one other thread.
  LatestValue<ServoStatus>& status() noexcept { return status_; }
  LatestValue<HeardCut>& heard() noexcept { return heard_; }
  FlightRecorder& recorder() noexcept { return recorder_; }

 private:
  bool send(const DeviceState& state) noexcept;
  bool turns(Vec3 tip_mm) const noexcept;
  void pass_to_replica(const wire::MotionSample& sample) noexcept;
  bool must_wake_link(std::uint32_t buttons) noexcept;
  Twist follow(const DeviceState& state, bool usable, std::uint64_t now_us, double dt_s) noexcept;
  void take_answers(std::uint64_t now_us) noexcept;
  Wrench requested_wrench(std::uint64_t now_us, bool cutting, double dt_s) noexcept;
  std::uint64_t answer_age(std::uint64_t now_us) const noexcept;
  SafetyInput safety_input(const DeviceState& state, bool usable,
                           const Wrench& requested) const noexcept;
  void note_softness(double mm_per_n) noexcept;
  void note_felt(bool on) noexcept;
  void note(const SafetyInput& seen, const Wrench& requested) noexcept;
  void note_heard(const SafetyInput& seen, bool usable) noexcept;
  void put_on_tapes(const DeviceState& state, bool usable, const SafetyInput& seen) noexcept;

  HapticDevice& device_;
  SampleRing& samples_;
  LatestValue<ServerWrench>& wrenches_;
  SampleListener& listener_;
  ReplicaExchange* replica_;
  Guidance* guidance_;
  ServoSettings settings_;
  std::atomic<ForceMode> mode_;
  std::array<TickTape*, kTapes> tapes_{};
  WrenchInterpolator interpolator_;
  PaperLoop paper_;
  LocalModel model_;
  GripHistory history_;
  VelocityEstimator velocity_;
  OutputStage output_;
  Supervisor supervisor_;
  FlightRecorder recorder_;
  LatestValue<ServoStatus> status_;
  LatestValue<HeardCut> heard_;
  ServoReport report_;
  PastGrip now_;
  /// Wrench of the followed participant, low-pass filtered.
  Wrench followed_{};
  /// Part of the requested wrench that comes from the guides.
  Wrench guided_{};
  /// The newest answer, of the replica or the server.
  Wrench answered_{};
  /// The wrench that the session computes at the newest pose, and the share of it that is output.
  Wrench computed_{};
  double share_ = 1;
  /// What is heard: the session's force, and the engaged area of the newest answer.
  double heard_n_ = 0, engaged_mm2_ = 0;
  Vec3 tip_mm_{};
  double jumped_mm_ = 0;
  bool has_grip_ = false;
  bool has_answer_ = false;
  /// Time of the replica's latest answer; 0: never.
  std::uint64_t replica_us_ = 0;
  /// The replica has a sample for which it was not woken.
  bool replica_waits_ = false;
  /// Samples for which the link was not woken, and the buttons for which it was.
  int unsent_ = 0;
  std::uint32_t sent_buttons_ = 0;
  std::uint64_t lost_now_ = 0;
  std::uint64_t noted_trips_ = 0;
  std::uint64_t start_us_ = 0;
  std::uint64_t last_us_ = 0;
};

}  // namespace kerf::agent
