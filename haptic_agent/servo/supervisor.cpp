// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/supervisor.h"

#include <algorithm>
#include <cmath>

#include "haptic_agent/device/units.h"

namespace kerf::agent {
namespace {

constexpr std::uint64_t kUsPerMs = 1000;
/// Conditions of arming and how long they must hold: the force must not start while the tip is
/// moving or already pressed against something.
constexpr std::uint64_t kArmingUs = 50 * kUsPerMs;
constexpr double kArmingMmPerS = 50;
constexpr double kArmingForceN = 0.2;
constexpr double kArmingTorqueNmm = 10;
/// Maximum age of a recent answer; older ones fade (silence_decay.h).
constexpr std::uint64_t kFreshUs = 20 * kUsPerMs;
/// After this time without an answer the device must be armed again.
constexpr std::uint64_t kDisarmUs = 1000 * kUsPerMs;
/// How long all conditions must hold before kDegraded becomes kActive again.
constexpr std::uint64_t kRecoverUs = 200 * kUsPerMs;
constexpr std::uint64_t kStarvingUs = 100 * kUsPerMs;
/// How long the user must let go to clear a trip.
constexpr std::uint64_t kForgiveUs = 300 * kUsPerMs;

bool outside(Vec3 p, Vec3 low, Vec3 high) noexcept {
  if (low == high) return false;
  return p.x < low.x || p.y < low.y || p.z < low.z || p.x > high.x || p.y > high.y || p.z > high.z;
}

bool small(const Wrench& wrench) noexcept {
  return length(wrench.force_n) < kArmingForceN && length(wrench.torque_nmm) < kArmingTorqueNmm;
}

}  // namespace

bool Supervisor::is_fresh(const SafetyInput& in) noexcept {
  return in.has_answer && in.answer_age_us <= kFreshUs;
}

bool Supervisor::is_small(const SafetyInput& in) noexcept {
  return small(in.requested - in.guided);
}

bool Supervisor::is_slow(const SafetyInput& in) noexcept { return in.tip_mm_per_s < kArmingMmPerS; }

bool Supervisor::reaches(const SafetyInput& in) const noexcept {
  return !outside(in.tip_mm, limits_.workspace_min_mm, limits_.workspace_max_mm);
}

TripCode Supervisor::fault(const SafetyInput& in) noexcept {
  if (!in.finite) return TripCode::kNotFinite;
  if (!is_finite(in.requested)) return TripCode::kRejectedWrench;
  if (!reaches(in)) return TripCode::kWorkspace;
  constexpr double kMsPerS = 1000;
  const double ticks = std::max(1.0, in.dt_s * kMsPerS);
  if (in.jumped_mm > limits_.jump_mm * ticks) return TripCode::kJump;
  if (in.tip_mm_per_s > limits_.tip_mm_per_s) return TripCode::kSpeed;
  if (in.turn_rad_per_s > limits_.turn_rad_per_s) return TripCode::kTurnSpeed;
  if (in.lost_now >= limits_.lost_in_a_row) return TripCode::kLostTicksInARow;
  if (lost_.share() > limits_.lost_share) return TripCode::kLostTicks;
  if (force_.too_much()) return TripCode::kThermalForce;
  if (torque_.too_much()) return TripCode::kThermalTorque;
  if (in.overdrawn) return TripCode::kOverdrawn;
  return TripCode::kNone;
}

void Supervisor::enter(ServoPhase phase, const SafetyInput& in) noexcept {
  phase_ = phase;
  since_us_ = in.now_us;
  steady_from_us_ = 0;
  starving_from_us_ = 0;
  pressed_ = false;
  asked_ = false;
  gesture_.restart();
  // Ignore ticks that were lost before there was a force, or that have tripped already.
  if (phase == ServoPhase::kRamp) lost_.clear();
}

bool Supervisor::lets_go(const SafetyInput& in) noexcept {
  if (!in.deadman) return true;
  pressed_ = pressed_ || in.cutting;
  return !limits_.has_deadman && pressed_ && !in.cutting;
}

/// Whether the user has re-armed by other means than letting go. Takes effect without a wait. The
/// gesture counts where it cannot be a stroke: without the button, and where no force would be
/// felt.
bool Supervisor::ends_trip(const SafetyInput& in) noexcept {
  const bool may = !limits_.has_deadman && in.present && in.finite && !in.cutting && reaches(in) &&
                   is_small(in) && in.jumped_mm <= limits_.jump_mm;
  const bool gestured = gesture_.done(in.tip_mm, may, in.now_us);
  return in.present && (asked_ || gestured);
}

/// Transitions kReady to kArmed, kArmed to kRamp and kSafe to kReady. Each requires a condition
/// that holds for some time.
void Supervisor::advance(const SafetyInput& in) noexcept {
  bool holds = false;
  std::uint64_t wait_us = 0;
  ServoPhase next = phase_;
  switch (phase_) {
    case ServoPhase::kReady:
      holds = in.present && in.deadman && is_fresh(in) && reaches(in);
      next = ServoPhase::kArmed;
      break;
    case ServoPhase::kArmed:
      holds = is_fresh(in) && is_slow(in) && is_small(in);
      wait_us = kArmingUs;
      next = ServoPhase::kRamp;
      break;
    case ServoPhase::kSafe:
      if (ends_trip(in)) return enter(ServoPhase::kReady, in);
      holds = in.present && lets_go(in);
      wait_us = kForgiveUs;
      next = ServoPhase::kReady;
      break;
    default:
      return;
  }
  if (!holds) {
    steady_from_us_ = 0;
    return;
  }
  if (steady_from_us_ == 0) steady_from_us_ = in.now_us;
  if (in.now_us - steady_from_us_ >= wait_us) enter(next, in);
}

/// Transitions between the phases with force: kRamp, kActive and kDegraded.
void Supervisor::monitor(const SafetyInput& in) noexcept {
  if (!in.starving) starving_from_us_ = 0;
  if (in.starving && starving_from_us_ == 0) starving_from_us_ = in.now_us;
  const bool starved = in.starving && in.now_us - starving_from_us_ > kStarvingUs;
  const bool well = in.answer_age_us <= kFreshUs && in.lost_now == 0 && !starved;
  if (phase_ == ServoPhase::kRamp) {
    const auto ramp_us = static_cast<std::uint64_t>(limits_.ramp_s * kUsPerS);
    if (in.now_us - since_us_ >= ramp_us) enter(ServoPhase::kActive, in);
    return;
  }
  if (phase_ == ServoPhase::kActive) {
    if (!well) enter(ServoPhase::kDegraded, in);
    return;
  }
  ++degraded_ticks_;
  if (!well) steady_from_us_ = 0;
  if (well && steady_from_us_ == 0) steady_from_us_ = in.now_us;
  if (well && in.now_us - steady_from_us_ >= kRecoverUs) enter(ServoPhase::kActive, in);
}

void Supervisor::step(const SafetyInput& in) noexcept {
  if (has_force()) {
    const TripCode trip = in.present ? fault(in) : TripCode::kDeviceLost;
    if (trip != TripCode::kNone) {
      code_ = trip;
      ++trips_;
      enter(ServoPhase::kSafe, in);
    } else if (!in.deadman || in.answer_age_us > kDisarmUs) {
      enter(ServoPhase::kReady, in);
    } else {
      monitor(in);
    }
  } else if (phase_ == ServoPhase::kArmed && !(in.present && in.deadman && in.finite)) {
    enter(ServoPhase::kReady, in);
  } else {
    advance(in);
  }
}

double Supervisor::tick(const SafetyInput& in) noexcept {
  if (!limits_.motors) {
    phase_ = ServoPhase::kActive;
    no_force_ = NoForce::kNoMotors;
    return 1;
  }
  lost_.note(in.now_us, in.lost_now, in.dt_s);
  force_.take(length(in.output.force_n), in.dt_s);
  torque_.take(length(in.output.torque_nmm), in.dt_s);
  step(in);
  no_force_ = why(in);
  if (!has_force()) return 0;
  if (phase_ != ServoPhase::kRamp) return lost_.gain();
  const double ramped_s = static_cast<double>(in.now_us - since_us_) / kUsPerS;
  const double ramp = limits_.ramp_s > 0 ? std::min(1.0, ramped_s / limits_.ramp_s) : 1.0;
  return ramp * lost_.gain();
}

}  // namespace kerf::agent
