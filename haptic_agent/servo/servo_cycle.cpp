// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/servo_cycle.h"

#include <algorithm>
#include <cmath>

#include "haptic_agent/device/units.h"
#include "haptic_agent/servo/contact_limits.h"
#include "haptic_agent/servo/silence_decay.h"

namespace kerf::agent {
namespace {

constexpr double kSPerUs = 1e-6;
constexpr std::uint64_t kTickUs = 1000;
/// Time constant of the low-pass filter for a followed participant's wrench, which arrives in
/// steps.
constexpr double kFeltS = 0.01;
/// Share of a device's stable damping that cuts and the passivity layer use.
constexpr double kStableShare = 0.5;
/// Share of mass / delay up to which a damper may be set.
constexpr double kDamperShare = 0.25;
/// Cosine of the turn that makes a corner, and the step below which noise of encoders may turn.
constexpr double kTurnCos = 0.9;
constexpr double kLeastStepMm = 0.01;

/// Gains that follow from the device's mass and latency: those of the dampers act a latency and a
/// period late, and what they may take from the least mass in that time is limited.
void adapt_to_mechanics(const DeviceCapabilities& device, ServoSettings& settings) {
  settings.velocity_cutoff_hz =
      velocity_cutoff_hz(device, settings.pivot_mm, settings.velocity_cutoff_hz);
  ContactLimits& contact = settings.model.contact;
  contact = contact_limits(device, settings.velocity_cutoff_hz);
  PassivitySettings& passivity = settings.passivity;
  passivity.latency_us = device.latency_us;
  if (contact.mass_kg > 0) {
    passivity.mass_kg = contact.mass_kg;
    passivity.inertia_kg_m2 = contact.inertia_kg_m2;
  }
  const double stable_per_s = kDamperShare / contact.velocity_delay_s;
  passivity.max_damping =
      std::min(passivity.max_damping, stable_per_s * passivity.mass_kg / kMmPerM);
  passivity.max_turn_damping =
      std::min(passivity.max_turn_damping, stable_per_s * passivity.inertia_kg_m2 * kNmmPerNm);
}

}  // namespace

ServoSettings settings_for(const DeviceCapabilities& device, ServoSettings settings) {
  settings.limits = within(device, settings.limits);
  if (device.max_damping_n_s_per_mm > 0) {
    settings.model.max_damping = kStableShare * device.max_damping_n_s_per_mm;
    settings.passivity.max_damping = settings.model.max_damping;
  }
  settings.model.max_vibration_hz = device.max_vibration_hz;
  adapt_to_mechanics(device, settings);
  settings.passivity.longest_tick_us = settings.safety.lost_in_a_row * kTickUs;
  settings.safety.continuous_force_n = device.continuous_force_n;
  settings.safety.continuous_torque_nmm = device.continuous_torque_nmm;
  settings.safety.workspace_min_mm = device.workspace_min_mm;
  settings.safety.workspace_max_mm = device.workspace_max_mm;
  settings.safety.has_deadman = device.has_deadman;
  settings.safety.motors = device.max_force_n > 0;
  return settings;
}

ServoCycle::ServoCycle(HapticDevice& device, SampleRing& samples,
                       LatestValue<ServerWrench>& wrenches, SampleListener& listener,
                       const ServoSettings& settings, ReplicaExchange* replica,
                       Guidance* guidance) noexcept
    : device_(device),
      samples_(samples),
      wrenches_(wrenches),
      listener_(listener),
      replica_(replica),
      guidance_(guidance),
      settings_(settings),
      model_(settings.model),
      velocity_(settings.velocity_cutoff_hz),
      output_(settings.passivity, settings.limits),
      supervisor_(settings.safety) {}

bool ServoCycle::tick(std::uint64_t now_us) noexcept {
  if (last_us_ == 0) {
    start_us_ = now_us;
    last_us_ = now_us - kTickUs;
  }
  const std::uint64_t passed_us = now_us - last_us_;
  const double dt_s = static_cast<double>(passed_us) * kSPerUs;
  lost_now_ = (passed_us + kTickUs / 2) / kTickUs;
  lost_now_ -= lost_now_ > 0 ? 1 : 0;
  last_us_ = now_us;

  const DeviceState state = device_.read(now_us);
  const bool usable = send(state);
  const Twist moved = follow(state, usable, now_us, dt_s);
  output_.settle(moved, now_us - passed_us, now_us);
  const bool cutting = (state.buttons & wire::kButtonCutting) != 0;
  computed_ = guided_ = {};
  heard_n_ = 0;
  const Wrench wrench = usable ? requested_wrench(now_us, cutting, dt_s) : Wrench{};
  const SafetyInput seen = safety_input(state, usable, wrench);
  const bool tripped = supervisor_.phase() == ServoPhase::kSafe;
  const double gain = supervisor_.tick(seen);
  if (tripped && supervisor_.phase() != ServoPhase::kSafe) output_.restart();
  device_.show_force(gain > 0);
  device_.write(usable && gain > 0
                    ? output_.release(wrench * gain, velocity_.velocity(), moved, dt_s, now_us)
                    : output_.silence(now_us));
  note_felt(usable && gain > 0);
  note(seen, wrench);
  note_heard(seen, usable);

  const bool timed_out = settings_.duration_us > 0 && now_us - start_us_ >= settings_.duration_us;
  if (state.finished || timed_out) {
    device_.write(Wrench{});
    return false;
  }
  return true;
}

bool ServoCycle::send(const DeviceState& state) noexcept {
  const double axis_error = std::abs(length(state.axis) - 1.0);
  if (!state.valid || !is_finite(state.tip_mm) || !(axis_error <= wire::kAxisLengthTolerance / 2)) {
    ++report_.invalid_poses;
    return false;
  }
  const bool motors = settings_.safety.motors;
  const wire::MotionSample sample{.time_us = state.time_us,
                                  .tip_mm = state.tip_mm,
                                  .axis = Vec3f(state.axis),
                                  .tool_id = state.tool_id != 0 ? state.tool_id : settings_.tool_id,
                                  .buttons = state.buttons | (motors ? wire::kButtonFelt : 0U),
                                  .felt_share = motors ? static_cast<float>(share_) : 0.0F};
  if (samples_.push(sample)) {
    ++report_.samples;
  } else {
    ++report_.ring_overflows;
  }
  if (replica_ != nullptr) pass_to_replica(sample);
  if (must_wake_link(sample.buttons)) listener_.sample_ready();
  return true;
}

/// Returns whether the tool travels by more than kTurnCos from its heading: the force of the cut
/// may change at once there, as where a plunge turns into a slot.
bool ServoCycle::turns(Vec3 tip_mm) const noexcept {
  const Vec3 step = tip_mm - tip_mm_;
  const double step_mm = length(step);
  return has_grip_ && step_mm > kLeastStepMm &&
         dot(step, now_.heading) < kTurnCos * step_mm * length(now_.heading);
}

/// Wakes the replica for every second sample: a thread that wakes costs more than a cut. The chips
/// and teeth of a milling cutter, and corners of the path, need an answer to each.
void ServoCycle::pass_to_replica(const wire::MotionSample& sample) noexcept {
  if (!replica_->push(sample)) ++report_.replica_overflows;
  replica_waits_ =
      !replica_waits_ && settings_.model.law != CutLaw::kMechanistic && !turns(sample.tip_mm);
  if (!replica_waits_) replica_->wake();
}

/// Returns whether the link must send now. While the replica answers, nothing waits for the server,
/// and samples are sent a few at a time: each wake-up costs a message in both directions.
bool ServoCycle::must_wake_link(std::uint32_t buttons) noexcept {
  const bool answered = replica_us_ != 0 && last_us_ - replica_us_ <= kReplicaFreshUs;
  ++unsent_;
  if (answered && buttons == sent_buttons_ && unsent_ < kSamplesPerWake) return false;
  unsent_ = 0;
  sent_buttons_ = buttons;
  return true;
}

/// Updates grip, velocity and history; returns the displacement since the previous tick.
Twist ServoCycle::follow(const DeviceState& state, bool usable, std::uint64_t now_us,
                         double dt_s) noexcept {
  if (!usable) {
    has_grip_ = false;
    velocity_.reset();
    return {};
  }
  const Grip grip{state.tip_mm + state.axis * settings_.pivot_mm, state.axis};
  const Twist moved = has_grip_ ? between(now_.grip, grip) : Twist{};
  const Vec3 step = has_grip_ ? state.tip_mm - tip_mm_ : Vec3{};
  jumped_mm_ = length(step);
  tip_mm_ = state.tip_mm;
  has_grip_ = true;
  // Answers refer to the sample's own time, which may be before the tick's.
  now_ = {.time_us = std::min(state.time_us, now_us),
          .grip = grip,
          .velocity = velocity_.take(moved, dt_s),
          .path_mm = now_.path_mm + jumped_mm_,
          .heading = LocalModel::heading(now_.heading, step)};
  history_.push(now_);
  return moved;
}

std::uint64_t ServoCycle::answer_age(std::uint64_t now_us) const noexcept {
  const ServerWrench& newest = interpolator_.newest();
  if (settings_.mode != ForceMode::kModel) {
    return answer_age_us(now_us, newest.arrival_us, newest.pose_us);
  }
  const bool replica = replica_us_ != 0 && now_us - replica_us_ <= kFullWrenchUs;
  if (!replica) return model_age_us(now_us, newest.arrival_us, newest.pose_us);
  // Forces also fade if the server's answers become too late.
  return std::max(replica_age_us(now_us, newest.arrival_us),
                  model_age_us(now_us, now_us, newest.pose_us));
}

void ServoCycle::take_answers(std::uint64_t now_us) noexcept {
  const auto grip_at = [this](std::uint64_t time_us) {
    const PastGrip* then = history_.at(time_us);
    return then != nullptr ? *then : now_;
  };
  ServerWrench next;
  if (wrenches_.read(next)) {
    interpolator_.take(next, now_us);
    model_.take(next, grip_at(next.pose_us), now_);
    has_answer_ = true;
    if (now_us - replica_us_ > kReplicaFreshUs) engaged_mm2_ = next.engaged_area_mm2;
  }
  if (replica_ != nullptr && replica_->read(next)) {
    model_.take_replica(next, grip_at(next.pose_us), now_);
    replica_us_ = now_us;
    engaged_mm2_ = next.engaged_area_mm2;
    ++report_.replica_answers;
  }
}

Wrench ServoCycle::requested_wrench(std::uint64_t now_us, bool cutting, double dt_s) noexcept {
  take_answers(now_us);
  if (!has_answer_) return {};
  const double share = wrench_share(answer_age(now_us));
  if (share < 1.0) ++report_.decayed_ticks;
  followed_ = followed_ + (interpolator_.newest().felt - followed_) * (dt_s / (kFeltS + dt_s));
  Wrench own = followed_;
  Wrench session = interpolator_.newest().wrench;
  switch (settings_.mode) {
    case ForceMode::kModel:
      own = own + model_.at(now_, cutting, dt_s);
      session = model_.computed();
      note_softness(model_.compliance_mm_per_n());
      break;
    case ForceMode::kInterpolated:
      own = own + interpolator_.at(now_us);
      break;
    case ForceMode::kHold:
      own = own + interpolator_.newest().wrench;
      break;
  }
  heard_n_ = length(session.force_n) * share;
  computed_ = followed_ + session;
  if (guidance_ != nullptr) {
    guided_ = guidance_->at(now_);
    own = own + guided_;
    computed_ = computed_ + guided_;
    guided_ = guided_ * share;
  }
  return own * share;
}

SafetyInput ServoCycle::safety_input(const DeviceState& state, bool usable,
                                     const Wrench& requested) const noexcept {
  const Twist& velocity = velocity_.velocity();
  const Vec3 arm = now_.grip.axis * -settings_.pivot_mm;
  return {.now_us = last_us_,
          .dt_s = static_cast<double>(lost_now_ + 1) * kTickUs * kSPerUs,
          .present = state.valid && state.phase == DevicePhase::kReady,
          .finite = usable || !state.valid,
          .deadman = (state.buttons & wire::kButtonDeadman) != 0,
          .cutting = (state.buttons & wire::kButtonCutting) != 0,
          .tip_mm = tip_mm_,
          .jumped_mm = jumped_mm_,
          .tip_mm_per_s = length(velocity.at(arm)),
          .turn_rad_per_s = length(velocity.angular),
          .has_answer = has_answer_,
          .answer_age_us = has_answer_ ? answer_age(last_us_) : 0,
          .lost_now = lost_now_,
          .requested = requested,
          .guided = guided_,
          .output = output_.released(),
          .starving = output_.passivity().starving(),
          .overdrawn = output_.passivity().overdrawn()};
}

void ServoCycle::note_softness(double mm_per_n) noexcept {
  if (mm_per_n > ServoReport::kSoftMmPerN) ++report_.soft_ticks;
  report_.softest_mm_per_n = std::max(report_.softest_mm_per_n, mm_per_n);
}

/// Compares the output with the computed wrench. `on`: the supervisor permits a force.
void ServoCycle::note_felt(bool on) noexcept {
  constexpr double kLeastLeverMm = 1;
  const double lever_mm = std::max(kLeastLeverMm, settings_.pivot_mm);
  share_ = felt_share(output_.released(), computed_, lever_mm);
  if (on) report_.felt.add(output_.released(), computed_, share_);
}

void ServoCycle::note(const SafetyInput& seen, const Wrench& requested) noexcept {
  report_.max_force_n = std::max(report_.max_force_n, length(output_.released().force_n));
  report_.max_torque_nmm = std::max(report_.max_torque_nmm, length(output_.released().torque_nmm));
  const Twist& velocity = velocity_.velocity();
  recorder_.note({.time_us = last_us_,
                  .tip_mm = tip_mm_,
                  .velocity_mm_per_s = velocity.linear,
                  .requested = requested,
                  .output = output_.released(),
                  .energy_mj = output_.passivity().account().level_mj(),
                  .answer_age_us = seen.answer_age_us,
                  .lost_now = lost_now_,
                  .phase = supervisor_.phase()});
  if (supervisor_.trips() != noted_trips_) recorder_.trip(supervisor_.code());
  noted_trips_ = supervisor_.trips();
  status_.write({.phase = supervisor_.phase(),
                 .code = supervisor_.code(),
                 .trips = noted_trips_,
                 .output = output_.released(),
                 .computed = computed_,
                 .energy_mj = output_.passivity().account().level_mj(),
                 .speed_mm_per_s = seen.tip_mm_per_s,
                 .answer_age_us = seen.answer_age_us,
                 .felt_share = share_});
}

void ServoCycle::note_heard(const SafetyInput& seen, bool usable) noexcept {
  heard_.write({.running = usable && seen.cutting,
                .force_n = heard_n_,
                .removed_mm3_per_s = engaged_mm2_ * seen.tip_mm_per_s});
}

}  // namespace kerf::agent
