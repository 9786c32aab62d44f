// SPDX-License-Identifier: Apache-2.0
#include "server/convert/tool_track.h"

#include <string>
#include <utility>

#include "server/convert/sample_pose.h"

namespace kerf {
namespace {

constexpr double kSecondsPerMicrosecond = 1e-6;

bool has_obstacles(const Sculpture& sculpture) { return !sculpture.settings().obstacles.empty(); }

/// Whether obstacles may touch a cutting tool, or stock its shank and holder.
bool has_contact(const Sculpture& sculpture, ToolId tool) {
  return has_obstacles(sculpture) || !sculpture.tool(tool)->non_cutting.empty();
}

}  // namespace

std::expected<ToolTrack::Step, Rejection> ToolTrack::take(const wire::MotionSample& sample,
                                                          const Sculpture& sculpture,
                                                          double speed_max_mm_per_s) {
  using enum wire::ErrorCode;
  const auto reject = [&](wire::ErrorCode code, const std::string& reason) {
    return std::unexpected(sample_rejection(sample, code, reason));
  };
  const auto pose = to_pose(sample);
  if (!pose) return std::unexpected(pose.error());
  if (sculpture.tool(sample.tool_id) == nullptr) {
    return reject(kUnknownTool, unknown_tool(sample.tool_id).reason);
  }
  const bool follows = pose_.has_value() && tool_ == sample.tool_id;
  const ToolPose from = pose_.value_or(*pose);
  const std::uint64_t from_us = std::exchange(time_us_, sample.time_us);
  const bool rests = follows && from == *pose;
  has_cut_here_ = has_cut_here_ && rests;
  pose_ = *pose;
  tool_ = sample.tool_id;
  if (!follows) return Step{};
  const std::uint64_t passed_us = sample.time_us > from_us ? sample.time_us - from_us : 0;
  const double duration_s = static_cast<double>(passed_us) * kSecondsPerMicrosecond;
  if (!cuts(sample)) return Touch{tool_, *pose, duration_s};
  const bool is_done = has_cut_here_ || passed_us == 0;
  if (rests && is_done && !has_obstacles(sculpture)) return Step{Rest{tool_, *pose, duration_s}};
  if (passed_us == 0) return reject(kBadMessage, "time_us must increase from sample to sample");
  const double distance_mm = length(pose->tip_mm - from.tip_mm);
  if (distance_mm > speed_max_mm_per_s * duration_s) {
    return reject(kTooFast, "speed " + std::to_string(distance_mm / duration_s) +
                                " mm/s; the limit is " + std::to_string(speed_max_mm_per_s) +
                                " mm/s while cutting");
  }
  has_cut_here_ = true;
  return MoveTool{tool_, from, *pose, duration_s, true};
}

bool ToolTrack::would_move(const wire::MotionSample& sample) const {
  if (!cuts(sample) || !pose_ || tool_ != sample.tool_id) return false;
  const auto pose = to_pose(sample);
  return pose.has_value() && (*pose != *pose_ || !has_cut_here_);
}

void add_touch(BatchSum& sum, const Sculpture& sculpture, const ToolTrack::Touch& touch) {
  const auto planes = sculpture.contact(touch.tool, touch.pose, false);
  sum.touch(planes);
  MotionResult touched;
  touched.wrench = touched.collision =
      wrench_of(planes, touch.pose, sculpture.settings().force.pivot_mm);
  sum.add(touched, touch.duration_s);
}

void add_motion(BatchSum& sum, const Sculpture& sculpture, const MoveTool& move,
                const MotionResult& result, HeldCut& held) {
  if (!move.feel) {
    held.drop();
    sum.add(result, move.duration_s);
    return;
  }
  held.add_motion(sum, sculpture, move, result);
  if (has_contact(sculpture, move.tool)) sum.touch(sculpture.contact(move.tool, move.to, true));
}

void add_rest(BatchSum& sum, const Sculpture& sculpture, const ToolTrack::Step& step,
              HeldCut& held) {
  const auto* rest = std::get_if<ToolTrack::Rest>(&step);
  if (rest == nullptr) {
    if (!std::holds_alternative<MoveTool>(step)) held.drop();
    return;
  }
  Wrench contact;
  if (has_contact(sculpture, rest->tool)) {
    const auto planes = sculpture.contact(rest->tool, rest->pose, true);
    sum.touch(planes);
    contact = wrench_of(planes, rest->pose, sculpture.settings().force.pivot_mm);
  }
  held.add_rest(sum, rest->tool, rest->pose, contact, rest->duration_s);
}

}  // namespace kerf
