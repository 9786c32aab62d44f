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
#include "haptic_agent/servo/mapping/hand_mapping.h"
#include "haptic_agent/servo/output_stage.h"
#include "haptic_agent/servo/paper_loop.h"
#include "haptic_agent/servo/pose_estimator.h"
#include "haptic_agent/servo/replica_exchange.h"
#include "haptic_agent/servo/sample_ring.h"
#include "haptic_agent/servo/servo_loop.h"
#include "haptic_agent/servo/supervisor.h"
#include "haptic_agent/servo/tick_tape.h"
#include "haptic_agent/servo/velocity_estimator.h"
#include "haptic_agent/servo/wrench_interpolator.h"

namespace kerf::agent {

/// Notified after each sample. Must not wait.
class SampleListener {
 public:
  virtual ~SampleListener() = default;
  virtual void sample_ready() noexcept = 0;
};

struct ServoSettings {
  WrenchLimits limits{};
  /// Tool of samples for which the device requests none.
  std::uint32_t tool_id = 1;
  /// Ends the loop after this time; 0: unlimited.
  std::uint64_t duration_us = 0;
  ForceMode mode = ForceMode::kModel;
  ModelSettings model{};
  PassivitySettings passivity{};
  SafetyLimits safety{.motors = false};
  /// Distance of the pivot from the tip along the axis, mm.
  double pivot_mm = 60;
  MappingSettings mapping{};
  /// Cut-off frequency of the velocity estimate; depends on the device.
  double velocity_cutoff_hz = 100;
  /// Quanta of the device's poses (DeviceCapabilities).
  double resolution_mm = 0, resolution_rad = 0;
  /// The tool cuts whenever force is permitted, as if the cutting button were pressed.
  bool always_cut = false;
};

/// Returns `settings` adapted to a device: stable stiffness and damping, ratings, workspace.
ServoSettings settings_for(const DeviceCapabilities& device, ServoSettings settings);

/// Counters of the cycle. Read after the loop has ended.
struct ServoReport {
  std::uint64_t samples = 0;
  /// Samples dropped because the ring to the link was full.
  std::uint64_t ring_overflows = 0;
  /// Samples dropped because the ring to the replica was full.
  std::uint64_t replica_overflows = 0;
  /// Ticks with a new answer from the replica.
  std::uint64_t replica_answers = 0;
  /// Ticks in which the device had no pose or an invalid one.
  std::uint64_t invalid_poses = 0;
  /// Ticks in which the wrench was faded because the answer was too old.
  std::uint64_t decayed_ticks = 0;
  double max_force_n = 0;
  double max_torque_nmm = 0;
  FeltReport felt{};
  /// Ticks per reason (NoForce) for which no force, or less than computed, was output.
  std::array<std::uint64_t, kNoForceNames.size()> no_force_ticks{};
  /// Ticks in which the force of a cut followed the tip by more than kSoftMmPerN because it shook
  /// the tool (CutCoupling), and the greatest compliance.
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
  NoForce no_force = NoForce::kNone;
  /// Factor of the force due to lost ticks.
  double lost_gain = 1;
};

/// Number of samples that the link sends together while the replica answers, and the age up to
/// which its answer counts, us. The server's copy of the path is late by as many ticks.
inline constexpr int kSamplesPerWake = 8;
inline constexpr std::uint64_t kReplicaFreshUs = 5'000;

/// One tick: reads the device, passes the pose to the link and the replica, and renders the newest
/// answer for the current pose. The wrench fades when the server is silent, is scaled by the
/// supervisor, made passive and limited. No allocation, lock, exception or printing.
class ServoCycle final : public ServoTask {
 public:
  /// The arguments must outlive the cycle. `replica` and `guidance` may be null.
  ServoCycle(HapticDevice& device, SampleRing& samples, LatestValue<ServerWrench>& wrenches,
             SampleListener& listener, const ServoSettings& settings,
             ReplicaExchange* replica = nullptr, Guidance* guidance = nullptr) noexcept;

  bool tick(std::uint64_t now_us) noexcept override;
  /// Re-arms after a trip at the user's request (Supervisor::rearm). From any thread, or a signal
  /// handler.
  void rearm() noexcept { rearm_.store(true, std::memory_order_relaxed); }

  /// Passes every tick to `tape` from now on, which must outlive the cycle; at most kTapes tapes.
  /// Call before the loop runs.
  static constexpr std::size_t kTapes = 2;
  void record_on(TickTape& tape) noexcept;
  /// Renders in this mode from the next tick on. From any thread.
  void set_mode(ForceMode mode) noexcept { mode_.store(mode, std::memory_order_relaxed); }

  const ServoReport& report() const noexcept { return report_; }
  const WrenchLimiter& limiter() const noexcept { return output_.limiter(); }
  const Passivity& passivity() const noexcept { return output_.passivity(); }
  const Supervisor& supervisor() const noexcept { return supervisor_; }
  /// Why there is no force now, or less than computed. From any thread.
  NoForce no_force() const noexcept { return reason_.load(std::memory_order_relaxed); }
  /// Each may be read by one other thread.
  LatestValue<ServoStatus>& status() noexcept { return status_; }
  LatestValue<HeardCut>& heard() noexcept { return heard_; }
  FlightRecorder& recorder() noexcept { return recorder_; }
  /// Changes of the mapping, from one other thread.
  LatestValue<MappingRequest>& mapping_requests() noexcept { return mapping_requests_; }
  /// From now on, writes the device's workspace in the block to `reach` whenever it changes, if it
  /// is known. Call before the first tick.
  void tell_reach(LatestValue<Reach>& reach) noexcept { reach_ = &reach; }

 private:
  void take_buttons(DeviceState& state) noexcept;
  bool is_usable(const DeviceState& state) noexcept;
  DeviceState map(const DeviceState& device, bool usable, std::uint64_t now_us) noexcept;
  void take_mapping() noexcept;
  void send(const DeviceState& tool) noexcept;
  bool turns(Vec3 step_mm) const noexcept;
  void estimate(const DeviceState& state, std::uint64_t time_us, double dt_s) noexcept;
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
  void put_on_tapes(const DeviceState& tool, bool usable, const SafetyInput& seen) noexcept;

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
  HandMapping hand_;
  LatestValue<MappingRequest> mapping_requests_;
  LatestValue<Reach>* reach_ = nullptr;
  GripHistory history_;
  VelocityEstimator velocity_;
  OutputStage output_;
  Supervisor supervisor_;
  FlightRecorder recorder_;
  LatestValue<ServoStatus> status_;
  LatestValue<HeardCut> heard_;
  ServoReport report_;
  PoseEstimator estimator_;
  VelocityEstimator estimated_velocity_;
  /// The grip as measured, for contacts, guides, energy and safety, and as estimated between
  /// encoder steps, for samples and cuts.
  PastGrip measured_, now_;
  /// Wrench of the followed participant, low-pass filtered (--feel).
  Wrench followed_{};
  /// Part of the requested wrench that comes from the guides.
  Wrench guided_{};
  /// The newest answer, from the replica or the server.
  Wrench answered_{};
  /// The wrench that the session computes at the newest pose, and the share of it that is output.
  Wrench computed_{};
  double share_ = 1;
  /// Input of the sound: the session's force, and the engaged area of the newest answer.
  double heard_n_ = 0, engaged_mm2_ = 0;
  /// The measured tip, and the estimated one.
  Vec3 tip_mm_{}, sent_tip_mm_{};
  /// Displacement of the estimated grip in this tick.
  Twist sent_moved_{};
  double jumped_mm_ = 0;
  bool turns_ = false;
  bool has_grip_ = false;
  bool has_answer_ = false;
  /// This tick's wrench was faded. The previous one was limited.
  bool faded_ = false, limited_ = false;
  std::atomic<bool> rearm_{false};
  std::atomic<NoForce> reason_{NoForce::kArming};
  /// The device's re-arm button was pressed in the previous tick.
  bool rearm_pressed_ = false;
  /// Time of the replica's latest answer; 0: never.
  std::uint64_t replica_us_ = 0;
  /// The replica has a sample for which it was not woken.
  bool replica_waits_ = false;
  /// The force of the replica's newest answer; whether it differs from the previous one.
  Vec3 replica_force_n_{};
  bool force_changes_ = false;
  /// Number of samples for which the link was not woken, and the buttons it was last woken with.
  int unsent_ = 0;
  std::uint32_t sent_buttons_ = 0;
  std::uint64_t lost_now_ = 0;
  std::uint64_t noted_trips_ = 0;
  std::uint64_t start_us_ = 0;
  std::uint64_t last_us_ = 0;
};

}  // namespace kerf::agent
