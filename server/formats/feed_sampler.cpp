// SPDX-License-Identifier: Apache-2.0
#include "server/formats/feed_sampler.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/math/rotation.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/number_text.h"
#include "server/formats/pose_grid.h"

namespace kerf {
namespace {

// A sample that turns the axis by more than this is halved, to stay within the kernel's limit.
constexpr double kSampleTurnMaxRad = std::numbers::pi / 2;
constexpr int kSampleHalvingsMax = 20;
// Least cut of a corner that is warned of: the default tolerance of a scene.
constexpr double kCornerWarnMm = 0.01;

// Distance of a point from a segment.
double distance_mm(Vec3 point, Vec3 from, Vec3 to) {
  const Vec3 along = to - from;
  const double square = dot(along, along);
  const double s = square > 0 ? std::clamp(dot(point - from, along) / square, 0.0, 1.0) : 0;
  return length(point - (from + along * s));
}

// A remainder of a chain within rounding belongs to its last sample.
constexpr double kWhole = 1 - 1e-12;

}  // namespace

ToolPose pose_on(const ProgramMotion& motion, double share) {
  return {motion.from.tip_mm + (motion.to.tip_mm - motion.from.tip_mm) * share,
          turned_axis(motion.from.axis, motion.to.axis, share)};
}

void FeedSampler::begin(const ProgramMotion& motion) {
  closed_ = ended_;
  tick_ = 1;
  from_s_ = 0;
  last_ = motion.from;
  chain_.push_back({motion, 0, motion.duration_s});
}

void FeedSampler::add(const ProgramMotion& motion) {
  if (chain_.empty()) return begin(motion);
  const Part& last = chain_.back();
  if (motion.from == last.motion.to && motion.tool == last.motion.tool) {
    const double begin_s = last.end_s;
    chain_.push_back({motion, begin_s, begin_s + motion.duration_s});
  } else {
    closed_ = true;
    next_chain_ = motion;
  }
}

bool FeedSampler::can_sample() const {
  if (chain_.empty()) return false;
  return closed_ || chain_.size() >= kWindow || next_s() < chain_.back().end_s * kWhole;
}

void FeedSampler::sample(std::vector<ProgramMotion>& out) {
  const double end_s = chain_.back().end_s;
  double to_s = next_s();
  if (closed_ ? to_s >= end_s * kWhole : to_s > end_s) to_s = end_s;
  sample(from_s_, to_s, 0, out);
  from_s_ = to_s;
  if (to_s >= next_s()) ++tick_;
  if (!closed_ || from_s_ < end_s) {
    while (chain_.size() > 1 && chain_.front().end_s < from_s_) chain_.pop_front();
    return;
  }
  chain_.clear();
  if (!next_chain_) return;
  const ProgramMotion first = *next_chain_;
  next_chain_.reset();
  begin(first);
}

std::size_t FeedSampler::part_at(double time_s) const {
  const auto it = std::ranges::lower_bound(chain_, time_s, {}, &Part::end_s);
  return std::min(static_cast<std::size_t>(it - chain_.begin()), chain_.size() - 1);
}

ToolPose FeedSampler::pose_at(double time_s) const {
  const Part& part = chain_[part_at(time_s)];
  const ProgramMotion& motion = part.motion;
  const double s = std::clamp((time_s - part.begin_s) / motion.duration_s, 0.0, 1.0);
  if (time_s >= part.end_s) return motion.to;
  return admit_pose(pose_on(motion, s));
}

void FeedSampler::sample(double from_s, double to_s, int halvings,
                         std::vector<ProgramMotion>& out) {
  const ToolPose to = pose_at(to_s);
  if (halvings < kSampleHalvingsMax &&
      angle_between(normalized(last_.axis), normalized(to.axis)) > kSampleTurnMaxRad) {
    const double middle = (from_s + to_s) / 2;
    sample(from_s, middle, halvings + 1, out);
    sample(middle, to_s, halvings + 1, out);
    return;
  }
  const std::size_t last = part_at(to_s);
  for (std::size_t i = part_at(from_s); i < last; ++i)
    corner_cut_mm_ =
        std::max(corner_cut_mm_, distance_mm(chain_[i].motion.to.tip_mm, last_.tip_mm, to.tip_mm));
  const ProgramMotion& motion = chain_[last].motion;
  out.push_back({.tool = motion.tool,
                 .from = last_,
                 .to = to,
                 .duration_s = to_s - from_s,
                 .line = motion.line,
                 .rapid = motion.rapid,
                 .file = motion.file});
  last_ = to;
}

std::optional<std::string> warning_of_corners(const std::string& program, double corner_cut_mm) {
  if (corner_cut_mm <= kCornerWarnMm) return std::nullopt;
  return program + ": at this rate corners are cut off by up to " +
         significant_text(corner_cut_mm, 3) + " mm";
}

double sample_count(const Program& program, double rate_hz) {
  double duration_s = 0;
  for (const ProgramMotion& motion : program.motions) duration_s += motion.duration_s;
  return std::ceil(duration_s * rate_hz);
}

Program sample_program(const Program& program, double rate_hz) {
  Program sampled{.name = program.name,
                  .motions = {},
                  .warnings = program.warnings,
                  .lines = program.lines,
                  .files = program.files,
                  .tool_changes = program.tool_changes,
                  .remarks = {}};
  FeedSampler sampler(rate_hz);
  for (const ProgramMotion& motion : program.motions) {
    while (sampler.can_sample()) sampler.sample(sampled.motions);
    sampler.add(motion);
  }
  sampler.end();
  while (sampler.can_sample()) sampler.sample(sampled.motions);
  if (auto warning = warning_of_corners(program.name, sampler.corner_cut_mm()))
    sampled.warnings.push_back(*std::move(warning));
  return sampled;
}

}  // namespace kerf
