// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/replica/other_tool.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptic_agent/device/units.h"
#include "kernel/tool/tool_bounds.h"

namespace kerf::agent {
namespace {

/// Time span of the poses that determine the expected path, s. A longer span reduces noise but
/// detects turns later.
constexpr double kFitS = 0.04;
/// Poses are kept for this long. The server's tiles with their cuts arrive earlier.
constexpr std::int64_t kKnownUs = 150'000;
constexpr std::size_t kKnownMax = 64;
constexpr std::uint64_t kRecutUs = 60'000;
/// Longest time between two poses for which the chord is cut.
constexpr std::int64_t kGapUs = 50'000;
/// Without a pose for this long the tool counts as gone.
constexpr std::uint64_t kGoneUs = 100'000;
/// Longest extrapolation beyond the newest pose.
constexpr std::uint64_t kAheadMaxUs = 350'000;
/// Duration of one chord of the expected path: when it is cut at once, and when it grows with time.
constexpr std::uint64_t kLongStepUs = 20'000;
constexpr std::uint64_t kStepUs = 4'000;
/// Weight of a new clock difference in the mean: jitter averages out over 16 poses.
constexpr double kOffsetShare = 1.0 / 16;
constexpr double kOffsetJumpUs = 200'000;
constexpr double kTurnMaxRad = 2;
/// Sanity limits of values from the server: clocks (70,000 years), speeds and chords.
constexpr std::uint64_t kTimeMaxUs = std::uint64_t{1} << 61;
constexpr double kSpeedMaxMmPerS = 1000;
constexpr double kChordMaxMm = 20;

bool meet(const Bounds& a, const Bounds& b) {
  return a.lo_mm.x <= b.hi_mm.x && b.lo_mm.x <= a.hi_mm.x && a.lo_mm.y <= b.hi_mm.y &&
         b.lo_mm.y <= a.hi_mm.y && a.lo_mm.z <= b.hi_mm.z && b.lo_mm.z <= a.hi_mm.z;
}

}  // namespace

void OtherTool::take(const wire::Intent& intent, std::uint64_t now_us) {
  if (intent.time_us > kTimeMaxUs || intent.agent_time_us > kTimeMaxUs) return;
  const auto time_us = static_cast<std::int64_t>(intent.time_us);
  const double offset_us =
      static_cast<double>(static_cast<std::int64_t>(intent.agent_time_us) - time_us);
  const bool is_same = intent.tool_id == tool_ && time_us >= newest_us_;
  if (is_same && time_us < newest_us_ + kStepMinUs) return;
  if (!is_same || std::abs(offset_us - offset_us_) > kOffsetJumpUs) forget();
  offset_us_ = known_.empty() ? offset_us : std::lerp(offset_us_, offset_us, kOffsetShare);
  tool_ = intent.tool_id;
  newest_us_ = time_us;
  known_.push_back({.time_us = time_us,
                    .pose = {intent.tip_mm, normalized(Vec3(intent.axis))},
                    .cuts = (intent.status & wire::kStatusCutting) != 0,
                    .taken_us = now_us});
  while (known_.front().time_us + kKnownUs < time_us || known_.size() > kKnownMax) {
    known_.pop_front();
  }
  is_new_ = true;
  is_known_cut_ = false;
  fit();
}

void OtherTool::forget() {
  is_dropped_ = is_dropped_ || has_cut_;
  known_.clear();
  cut_.clear();
}

void OtherTool::restart() {
  cut_.clear();
  is_known_cut_ = has_cut_ = is_dropped_ = false;
}

bool OtherTool::is_present(std::uint64_t now_us) const {
  return !known_.empty() && now_us < known_.back().taken_us + kGoneUs;
}

bool OtherTool::is_cutting(std::uint64_t now_us) const {
  if (!known_.empty() && known_.back().cuts) return true;
  return std::ranges::any_of(known_, [&](const Known& known) {
    return known.cuts && known.taken_us + kRecutUs >= now_us;
  });
}

std::uint64_t OtherTool::in_time(const Known& known) const {
  return static_cast<std::uint64_t>(known.time_us + std::llround(offset_us_));
}

/// Fits x = x0 + v t + a t²/2 to the poses before the newest one, x0, by least squares.
void OtherTool::fit() {
  const Known& newest = known_.back();
  double t2 = 0, t3 = 0, t4 = 0;
  Vec3 x1, x2, axis1;
  for (const Known& known : known_) {
    const double t = static_cast<double>(known.time_us - newest.time_us) * kSPerUs;
    if (t < -kFitS) continue;
    const Vec3 x = known.pose.tip_mm - newest.pose.tip_mm;
    t2 += t * t;
    t3 += t * t * t / 2;
    t4 += t * t * t * t / 4;
    x1 = x1 + x * t;
    x2 = x2 + x * (t * t / 2);
    axis1 = axis1 + (known.pose.axis - newest.pose.axis) * t;
  }
  velocity_mm_per_s_ = turn_per_s_ = {};
  curvature_per_mm_ = speed_up_mm_per_s2_ = 0;
  if (t2 <= 0) return;
  turn_per_s_ = axis1 * (1 / t2);
  const double determinant = t2 * t4 - t3 * t3;
  const bool curved = determinant > 1e-6 * t2 * t4;
  velocity_mm_per_s_ = curved ? (x1 * t4 - x2 * t3) * (1 / determinant) : x1 * (1 / t2);
  const double speed = length(velocity_mm_per_s_);
  if (!curved || speed <= 0) return;
  const Vec3 acceleration = (x2 * t2 - x1 * t3) * (1 / determinant);
  const Vec3 ahead = velocity_mm_per_s_ * (1 / speed);
  speed_up_mm_per_s2_ = dot(acceleration, ahead);
  const Vec3 across = acceleration - ahead * speed_up_mm_per_s2_;
  const double most = length(across);
  if (most <= 0) return;
  inward_ = across * (1 / most);
  curvature_per_mm_ = most / (speed * speed);
}

ToolPose OtherTool::at(std::uint64_t time_us) const {
  const Known& newest = known_.back();
  const double passed_us = static_cast<double>(time_us) - static_cast<double>(in_time(newest));
  const double t = std::clamp(passed_us, 0.0, static_cast<double>(kAheadMaxUs)) * kSPerUs;
  const double speed = length(velocity_mm_per_s_);
  if (!(speed > 0 && speed <= kSpeedMaxMmPerS)) return newest.pose;
  // The tool brakes to rest at most, and its acceleration is bounded.
  const double braked = speed_up_mm_per_s2_ < 0 ? std::min(t, -speed / speed_up_mm_per_s2_) : t;
  const double far =
      std::min(speed * braked + speed_up_mm_per_s2_ * braked * braked / 2, 1.5 * speed * t);
  const Vec3 ahead = velocity_mm_per_s_ * (1 / speed);
  const double angle = std::min(curvature_per_mm_ * far, kTurnMaxRad);
  Vec3 moved = ahead * far;
  if (angle > 1e-6) {
    const double radius = far / angle;
    moved = ahead * (radius * std::sin(angle)) + inward_ * (radius * (1 - std::cos(angle)));
  }
  return {newest.pose.tip_mm + moved, normalized(newest.pose.axis + turn_per_s_ * t)};
}

/// Returns the tip at a time on the path that has been cut.
Vec3 OtherTool::cut_at(std::uint64_t time_us) const {
  const auto after = std::ranges::lower_bound(cut_, time_us, {}, &Placed::time_us);
  if (after == cut_.begin()) return after->pose.tip_mm;
  if (after == cut_.end()) return cut_.back().pose.tip_mm;
  const Placed& before = *(after - 1);
  const double share = static_cast<double>(time_us - before.time_us) /
                       static_cast<double>(after->time_us - before.time_us);
  return before.pose.tip_mm + (after->pose.tip_mm - before.pose.tip_mm) * share;
}

bool OtherTool::is_off(std::uint64_t now_us, double off_mm) {
  if (is_dropped_) return true;
  if (cut_.empty() || !std::exchange(is_new_, false)) return false;
  const Known& newest = known_.back();
  const std::uint64_t until_us = std::min(now_us, cut_.back().time_us);
  const bool off = !newest.cuts || length(newest.pose.tip_mm - cut_at(in_time(newest))) > off_mm ||
                   length(at(until_us).tip_mm - cut_at(until_us)) > off_mm;
  if (off && !has_cut_) restart();  // out of reach, and the block has no cuts to restore
  return off && has_cut_;
}

void OtherTool::cut_to(Sculpture& block, const Bounds& reach, const Placed& to) {
  const MoveTool move{tool_, cut_.back().pose, to.pose, 0, false};
  cut_.push_back(to);
  const Tool* tool = block.tool(tool_);
  if (tool == nullptr || length(move.to.tip_mm - move.from.tip_mm) > kChordMaxMm) return;
  if (!meet(reach, joined(tool_bounds(*tool, move.from), tool_bounds(*tool, move.to)))) return;
  has_cut_ = true;
  (void)block.apply(move);  // ignores a motion out of range
}

void OtherTool::cut_known(Sculpture& block, const Bounds& reach, std::uint64_t now_us) {
  const Known* before = nullptr;
  for (const Known& known : known_) {
    const bool recent = known.taken_us + kRecutUs >= now_us;
    if (before != nullptr && recent && known.cuts && known.time_us < before->time_us + kGapUs) {
      cut_.push_back({in_time(*before), before->pose});
      cut_to(block, reach, {in_time(known), known.pose});
    }
    before = &known;
  }
  cut_.clear();
  if (known_.back().cuts) cut_.push_back({in_time(known_.back()), known_.back().pose});
}

void OtherTool::cut(Sculpture& block, const Bounds& reach, std::uint64_t now_us) {
  if (known_.empty()) return;
  std::uint64_t step_us = kStepUs;
  if (cut_.empty() && !std::exchange(is_known_cut_, true)) {
    cut_known(block, reach, now_us);
    step_us = kLongStepUs;
  }
  if (cut_.empty()) return;
  const std::uint64_t until_us = std::min(now_us, in_time(known_.back()) + kAheadMaxUs);
  while (cut_.back().time_us + step_us <= until_us) {
    const std::uint64_t next_us = cut_.back().time_us + step_us;
    cut_to(block, reach, {next_us, at(next_us)});
  }
  const bool is_short = cut_.back().time_us >= until_us;
  if (step_us == kLongStepUs && !is_short) cut_to(block, reach, {until_us, at(until_us)});
  while (cut_.front().time_us + kAheadMaxUs < now_us && cut_.size() > 1) cut_.pop_front();
}

}  // namespace kerf::agent
