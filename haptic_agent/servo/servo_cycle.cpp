#include "haptic_agent/servo/servo_cycle.h"

#include <algorithm>
#include <cmath>

#include "haptic_agent/servo/silence_decay.h"

namespace kerf::agent {
namespace {

constexpr double kSPerUs = 1e-6;
/// A step of the wrench is never allowed more rise than this time would give, so that a loop that
/// stood still does not come back with a jerk.
constexpr double kLongestStepS = 0.002;

wire::Vec3f to_wire_axis(Vec3 v) noexcept {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

}  // namespace

ServoCycle::ServoCycle(HapticDevice& device, SampleRing& samples,
                       LatestValue<ServerWrench>& wrenches, SampleListener& listener,
                       const ServoSettings& settings) noexcept
    : device_(device),
      samples_(samples),
      wrenches_(wrenches),
      listener_(listener),
      settings_(settings),
      limiter_(settings.limits) {}

bool ServoCycle::tick(std::uint64_t now_us) noexcept {
  if (last_us_ == 0) start_us_ = last_us_ = now_us;
  const double dt_s = std::min(static_cast<double>(now_us - last_us_) * kSPerUs, kLongestStepS);
  last_us_ = now_us;

  const DeviceState state = device_.read(now_us);
  const bool usable = send(state);
  const Wrench shown = limiter_.limit(usable ? wanted(now_us) : Wrench{}, dt_s);
  device_.write(shown);

  report_.max_force_n = std::max(report_.max_force_n, length(shown.force_n));
  report_.max_torque_nmm = std::max(report_.max_torque_nmm, length(shown.torque_nmm));
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
  const wire::MotionSample sample{.time_us = state.time_us,
                                  .tip_mm = {state.tip_mm.x, state.tip_mm.y, state.tip_mm.z},
                                  .axis = to_wire_axis(state.axis),
                                  .tool_id = state.tool_id != 0 ? state.tool_id : settings_.tool_id,
                                  .buttons = state.buttons};
  if (samples_.push(sample)) {
    ++report_.samples;
  } else {
    ++report_.ring_overflows;
  }
  listener_.sample_ready();
  return true;
}

Wrench ServoCycle::wanted(std::uint64_t now_us) noexcept {
  ServerWrench next;
  if (wrenches_.read(next)) interpolator_.take(next, now_us);
  if (!interpolator_.has_wrench()) return {};
  const ServerWrench& newest = interpolator_.newest();
  const double share = wrench_share(answer_age_us(now_us, newest.arrival_us, newest.pose_us));
  if (share < 1.0) ++report_.decayed_ticks;
  const Wrench wrench = interpolator_.at(now_us);
  return {.force_n = wrench.force_n * share, .torque_nmm = wrench.torque_nmm * share};
}

}  // namespace kerf::agent
