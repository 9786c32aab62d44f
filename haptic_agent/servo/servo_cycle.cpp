// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/servo_cycle.h"

#include <algorithm>
#include <cmath>

#include "haptic_agent/device/units.h"
#include "haptic_agent/servo/mapping/block_settings.h"
#include "haptic_agent/servo/silence_decay.h"

namespace kerf::agent {
namespace {

constexpr std::uint64_t kTickUs = 1000;
/// Time constant of the low-pass filter for a followed participant's wrench, which arrives in
/// steps.
constexpr double kFeltS = 0.01;
/// Cosine of the turn that counts as a corner, and the length of a step whose direction may be
/// encoder noise.
constexpr double kTurnCos = 0.9;
constexpr double kLeastStepMm = 0.01;
/// Relative difference of two answers from which on the force counts as changing.
constexpr double kChangeShare = 0.03;

}  // namespace

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
      mode_(settings.mode),
      model_(settings.model),
      hand_(settings.mapping),
      velocity_(settings.velocity_cutoff_hz),
      output_(settings.passivity, settings.limits),
      supervisor_(settings.safety),
      estimator_(settings.resolution_mm, settings.resolution_rad),
      estimated_velocity_(settings.velocity_cutoff_hz) {
  if (guidance_ != nullptr) guidance_->adapt(block_settings(settings_, settings_.mapping.at_start));
}

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

  DeviceState state = device_.read(now_us);
  take_buttons(state);
  const bool usable = is_usable(state);
  const Twist moved = follow(state, usable, now_us, dt_s);
  const DeviceState tool = map(state, usable, now_us);
  if (usable) send(tool);
  output_.settle(moved, now_us - passed_us, now_us);
  const bool cutting = (tool.buttons & wire::kButtonCutting) != 0;
  computed_ = guided_ = {};
  faded_ = false;
  heard_n_ = 0;
  const Wrench wrench = usable ? requested_wrench(now_us, cutting, dt_s) : Wrench{};
  const SafetyInput seen = safety_input(state, usable, wrench);
  const bool tripped = supervisor_.phase() == ServoPhase::kSafe;
  // The supervisor sees the whole wrench, so that it does not arm a tool that is pressed against
  // something.
  const double gain = supervisor_.tick(seen) * hand_.share(now_us);
  if (tripped && supervisor_.phase() != ServoPhase::kSafe) output_.restart();
  device_.show_force(gain > 0);
  const std::uint64_t saturated = output_.limiter().saturated();
  device_.write(usable && gain > 0
                    ? output_.release(wrench * gain, now_.velocity, sent_moved_, dt_s, now_us)
                    : output_.silence(now_us));
  limited_ = output_.limiter().saturated() != saturated;
  note_felt(usable && gain > 0);
  note(seen, wrench);
  note_heard(seen, usable);
  put_on_tapes(tool, usable, seen);

  const bool timed_out = settings_.duration_us > 0 && now_us - start_us_ >= settings_.duration_us;
  if (state.finished || timed_out) {
    device_.write(Wrench{});
    return false;
  }
  return true;
}

/// Handles the request to re-arm, and presses the cutting button of a device without one while the
/// device is held and force is permitted.
void ServoCycle::take_buttons(DeviceState& state) noexcept {
  const bool pressed = (state.buttons & kButtonRearm) != 0;
  if (rearm_.exchange(false, std::memory_order_relaxed) || (pressed && !rearm_pressed_)) {
    supervisor_.rearm();
  }
  rearm_pressed_ = pressed;
  state.buttons &= ~kButtonRearm;
  const ServoPhase phase = supervisor_.phase();
  const bool on = phase >= ServoPhase::kRamp && phase < ServoPhase::kSafe &&
                  (state.buttons & wire::kButtonDeadman) != 0;
  if (settings_.always_cut && on) state.buttons |= wire::kButtonCutting;
}

bool ServoCycle::is_usable(const DeviceState& state) noexcept {
  const double axis_error = std::abs(length(state.axis) - 1.0);
  if (state.valid && is_finite(state.tip_mm) && axis_error <= wire::kAxisLengthTolerance / 2) {
    return true;
  }
  ++report_.invalid_poses;
  return false;
}

/// Returns the state of the tool in the block, from the estimated pose. Model and output work in
/// device space; samples, answers and guides are in the block (mapping/README.md).
DeviceState ServoCycle::map(const DeviceState& device, bool usable, std::uint64_t now_us) noexcept {
  if (MappingRequest request; mapping_requests_.read(request)) hand_.change(request);
  DeviceState estimated = device;
  if (usable) {
    estimated.tip_mm = sent_tip_mm_;
    estimated.axis = now_.grip.axis;
  }
  const DeviceState tool = hand_.follow(estimated, now_us);
  if (hand_.has_resumed()) take_mapping();
  if (reach_ != nullptr && (hand_.has_resumed() || last_us_ == start_us_)) {
    const SpaceBox workspace{settings_.safety.workspace_min_mm, settings_.safety.workspace_max_mm};
    if (workspace.has_volume()) reach_->write(hand_.map().reach_of(workspace));
  }
  return tool;
}

/// Discards answers for the previous position of device space in the block.
void ServoCycle::take_mapping() noexcept {
  model_ = LocalModel(settings_.model);
  interpolator_.forget_wrench();
  paper_ = {};
  answered_ = {};
  engaged_mm2_ = 0;
  if (guidance_ != nullptr) guidance_->adapt(block_settings(settings_, hand_.map().mapping()));
}

/// Passes the pose of the tool to the link and the replica.
void ServoCycle::send(const DeviceState& tool) noexcept {
  const bool motors = settings_.safety.motors;
  const wire::MotionSample sample{.time_us = tool.time_us,
                                  .tip_mm = tool.tip_mm,
                                  .axis = Vec3f(tool.axis),
                                  .tool_id = tool.tool_id != 0 ? tool.tool_id : settings_.tool_id,
                                  .buttons = tool.buttons | (motors ? wire::kButtonFelt : 0U),
                                  .felt_share = motors ? static_cast<float>(share_) : 0.0F};
  if (samples_.push(sample)) {
    ++report_.samples;
  } else {
    ++report_.ring_overflows;
  }
  if (replica_ != nullptr) pass_to_replica(sample);
  if (must_wake_link(sample.buttons)) listener_.sample_ready();
}

/// Returns whether the tool deviates by more than kTurnCos from its heading. The force of the cut
/// may change at once there, as where a plunge turns into a slot.
bool ServoCycle::turns(Vec3 step_mm) const noexcept {
  const double size_mm = length(step_mm);
  return size_mm > kLeastStepMm &&
         dot(step_mm, now_.heading) < kTurnCos * size_mm * length(now_.heading);
}

/// Wakes the replica for every second sample, because a wake-up costs more than a cut. Chips and
/// teeth of a milling cutter, corners of the path, a changing force (as in a plunge) and the mean
/// of an update in mode paper need an answer to each sample.
void ServoCycle::pass_to_replica(const wire::MotionSample& sample) noexcept {
  if (!replica_->push(sample)) ++report_.replica_overflows;
  replica_waits_ = !replica_waits_ && settings_.model.law != CutLaw::kMechanistic && !turns_ &&
                   !force_changes_ && mode_.load(std::memory_order_relaxed) != ForceMode::kPaper;
  if (!replica_waits_) replica_->wake();
}

/// Returns whether the link must send now. While the replica answers, the server's answer is not
/// urgent, and samples are sent a few at a time: each wake-up costs a message in both directions.
bool ServoCycle::must_wake_link(std::uint32_t buttons) noexcept {
  const bool answered = replica_us_ != 0 && last_us_ - replica_us_ <= kReplicaFreshUs;
  ++unsent_;
  if (answered && buttons == sent_buttons_ && unsent_ < kSamplesPerWake) return false;
  unsent_ = 0;
  sent_buttons_ = buttons;
  return true;
}

/// Updates grip, velocity and history. Returns the displacement measured since the previous tick.
Twist ServoCycle::follow(const DeviceState& state, bool usable, std::uint64_t now_us,
                         double dt_s) noexcept {
  if (!usable) {
    has_grip_ = false;
    velocity_.reset();
    estimated_velocity_.reset();
    estimator_.reset();
    return {};
  }
  const Grip grip{state.tip_mm + state.axis * settings_.pivot_mm, state.axis};
  const Twist moved = has_grip_ ? between(measured_.grip, grip) : Twist{};
  jumped_mm_ = has_grip_ ? length(state.tip_mm - tip_mm_) : 0;
  tip_mm_ = state.tip_mm;
  estimate(state, std::min(state.time_us, now_us), dt_s);
  measured_ = now_;
  measured_.grip = grip;
  measured_.velocity = velocity_.take(moved, dt_s);
  has_grip_ = true;
  return moved;
}

/// Sets the grip that is sent, `dt_s` after the last one. Answers refer to the sample's own time,
/// which may be before the tick's.
void ServoCycle::estimate(const DeviceState& state, std::uint64_t time_us, double dt_s) noexcept {
  PoseEstimator::Pose pose{state.tip_mm, state.axis};
  // The path of a device without motors is cut as measured, because none of its force is felt.
  if (settings_.safety.motors) pose = estimator_.take(pose, dt_s, time_us != now_.time_us);
  const Grip grip{pose.tip_mm + pose.axis * settings_.pivot_mm, pose.axis};
  sent_moved_ = has_grip_ ? between(now_.grip, grip) : Twist{};
  const Vec3 step_mm = has_grip_ ? pose.tip_mm - sent_tip_mm_ : Vec3{};
  turns_ = turns(step_mm);
  sent_tip_mm_ = pose.tip_mm;
  now_ = {.time_us = time_us,
          .grip = grip,
          .velocity = estimated_velocity_.take(sent_moved_, dt_s),
          .path_mm = now_.path_mm + length(step_mm),
          .heading = LocalModel::heading(now_.heading, step_mm)};
  history_.push(now_);
}

std::uint64_t ServoCycle::answer_age(std::uint64_t now_us) const noexcept {
  const ServerWrench& newest = interpolator_.newest();
  const ForceMode mode = mode_.load(std::memory_order_relaxed);
  const bool replica = replica_us_ != 0 && now_us - replica_us_ <= kFullWrenchUs;
  if (mode == ForceMode::kInterpolated || mode == ForceMode::kHold ||
      (mode == ForceMode::kPaper && !replica)) {
    return answer_age_us(now_us, newest.arrival_us, newest.pose_us);
  }
  if (!replica) return model_age_us(now_us, newest.arrival_us, newest.pose_us);
  // Also fade if the server's answers become too late.
  return std::max(replica_age_us(now_us, newest.arrival_us),
                  model_age_us(now_us, now_us, newest.pose_us));
}

void ServoCycle::take_answers(std::uint64_t now_us) noexcept {
  const auto grip_at = [this](std::uint64_t time_us) {
    const PastGrip* then = history_.at(time_us);
    return then != nullptr ? *then : now_;
  };
  const auto in_device = [this](ServerWrench answer, const PastGrip& then) {
    if (!hand_.holds_for(answer.pose_us)) answer.forget_place();
    return hand_.map().to_device(answer, then.grip.axis, settings_.pivot_mm);
  };
  ServerWrench next;
  if (wrenches_.read(next)) {
    const PastGrip then = grip_at(next.pose_us);
    next = in_device(next, then);
    interpolator_.take(next, now_us);
    if (hand_.holds_for(next.pose_us)) model_.take(next, then, measured_);
    has_answer_ = true;
    if (now_us - replica_us_ > kReplicaFreshUs) {
      engaged_mm2_ = next.engaged_area_mm2;
      paper_.take(next.wrench);
      answered_ = next.wrench;
    }
  }
  if (replica_ != nullptr && replica_->read(next)) {
    const PastGrip then = grip_at(next.pose_us);
    next = in_device(next, then);
    const double change_n = length(next.wrench.force_n - replica_force_n_);
    force_changes_ = change_n > kChangeShare * length(next.wrench.force_n);
    replica_force_n_ = next.wrench.force_n;
    if (hand_.holds_for(next.pose_us)) model_.take_replica(next, then, measured_);
    replica_us_ = now_us;
    engaged_mm2_ = next.engaged_area_mm2;
    paper_.take(next.wrench);
    answered_ = next.wrench;
    ++report_.replica_answers;
  }
}

Wrench ServoCycle::requested_wrench(std::uint64_t now_us, bool cutting, double dt_s) noexcept {
  take_answers(now_us);
  if (!has_answer_ || hand_.is_away()) return {};
  const double share = wrench_share(answer_age(now_us));
  faded_ = share < 1.0;
  if (faded_) ++report_.decayed_ticks;
  followed_ = followed_ + (interpolator_.newest().felt - followed_) * (dt_s / (kFeltS + dt_s));
  Wrench own = followed_;
  Wrench session = interpolator_.newest().wrench;
  // Compute it in every mode, so that a change of the mode finds the current update.
  const Wrench paper = paper_.at(now_us);
  switch (mode_.load(std::memory_order_relaxed)) {
    case ForceMode::kModel:
      own = own + model_.at(now_, measured_, cutting, dt_s);
      session = model_.computed();
      note_softness(model_.compliance_mm_per_n());
      break;
    case ForceMode::kInterpolated:
      own = own + interpolator_.at(now_us);
      break;
    case ForceMode::kHold:
      own = own + interpolator_.newest().wrench;
      break;
    case ForceMode::kPaper:
      own = own + paper;
      session = answered_;
      break;
    case ForceMode::kSilent:
      session = {};
      break;
  }
  heard_n_ = length(session.force_n) * share;
  computed_ = followed_ + session;
  if (guidance_ != nullptr) {
    guided_ = hand_.map().to_device(guidance_->at(hand_.map().to_block(measured_)));
    own = own + guided_;
    computed_ = computed_ + guided_;
    guided_ = guided_ * share;
  }
  return own * share;
}

SafetyInput ServoCycle::safety_input(const DeviceState& state, bool usable,
                                     const Wrench& requested) const noexcept {
  const Twist& velocity = velocity_.velocity();
  const Vec3 arm = measured_.grip.axis * -settings_.pivot_mm;
  return {.now_us = last_us_,
          .dt_s = static_cast<double>(lost_now_ + 1) * kTickUs * kSPerUs,
          .present = state.valid && state.phase == DevicePhase::kReady,
          .finite = usable || !state.valid,
          .deadman = (state.buttons & wire::kButtonDeadman) != 0,
          .cutting = (state.buttons & wire::kButtonCutting) != 0,
          .device = state.phase,
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
          .overdrawn = output_.passivity().overdrawn(),
          .faded = faded_,
          .limited = limited_,
          .clutched = hand_.is_away()};
}

}  // namespace kerf::agent
