// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_decimator.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/rotation.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/number_text.h"
#include "server/formats/program_writing.h"

namespace kerf {
namespace {

/// Most poses of one joined motion; every new motion is compared with all of them.
constexpr std::size_t kPosesMax = 128;

double angle(const ToolPose& a, const ToolPose& b) {
  return angle_between(normalized(a.axis), normalized(b.axis));
}

}  // namespace

ProgramDecimator::ProgramDecimator(std::unique_ptr<ProgramWriter> writer, const Scene& scene,
                                   double tolerance_mm)
    : writer_(std::move(writer)), scene_(scene), tolerance_mm_(tolerance_mm) {
  writer_->note("motions are joined where no point of the tool strays more than " +
                exact_text(tolerance_mm) + " mm");
}

void ProgramDecimator::note(const std::string& line) { writer_->note(line); }

WriteResult ProgramDecimator::add(const ProgramMotion& motion) {
  const bool rests = motion.from == motion.to;
  const bool follows = joined_ && !rests && joined_->tool == motion.tool &&
                       joined_->rapid == motion.rapid && joined_->to == motion.from &&
                       path_.size() < kPosesMax;
  if (follows && fits(motion.to)) {
    joined_->to = motion.to;
    joined_->duration_s += motion.duration_s;
    path_.push_back(motion.to);
    return {};
  }
  if (auto done = flush(); !done) return done;
  if (rests) return writer_->add(motion);
  joined_ = motion;
  path_ = {motion.from, motion.to};
  return {};
}

/// Whether the straight motion to `end` stays within the tolerance of all poses of the path and of
/// the poses halfway between them, where great circles deviate most.
bool ProgramDecimator::fits(const ToolPose& end) const {
  const double reach = reach_mm(scene_, joined_->tool);
  const ToolPose& start = path_.front();
  const double turn = angle(start, end);
  if (turn > kTurnMaxRad) return false;
  // Path length of the tip plus that of the far end, which grows with every motion of the tool.
  double whole = 0;
  std::vector<double> at{0};
  for (std::size_t n = 0; n < path_.size(); ++n) {
    const ToolPose& next = n + 1 < path_.size() ? path_[n + 1] : end;
    whole += length(next.tip_mm - path_[n].tip_mm) + reach * angle(path_[n], next);
    at.push_back(whole);
  }
  const auto strays = [&](const ToolPose& pose, double share) {
    const Vec3 axis = turned_axis(start.axis, end.axis, share);
    const Vec3 tip = start.tip_mm + (end.tip_mm - start.tip_mm) * share;
    const Vec3 far = tip + axis * reach - (pose.tip_mm + normalized(pose.axis) * reach);
    return std::max(length(tip - pose.tip_mm), length(far)) > tolerance_mm_;
  };
  for (std::size_t n = 1; n < at.size(); ++n) {
    const ToolPose& from = path_[n - 1];
    const ToolPose& to = n < path_.size() ? path_[n] : end;
    const ToolPose middle{(from.tip_mm + to.tip_mm) * 0.5, turned_axis(from.axis, to.axis, 0.5)};
    if (strays(to, at[n] / whole) || strays(middle, (at[n - 1] + at[n]) / 2 / whole)) return false;
  }
  return true;
}

WriteResult ProgramDecimator::flush() {
  if (!joined_) return {};
  const ProgramMotion motion = *joined_;
  joined_.reset();
  return writer_->add(motion);
}

WriteResult ProgramDecimator::remark(const MachineRemark& said) {
  if (WriteResult flushed = flush(); !flushed) return flushed;
  return writer_->remark(said);
}

WriteResult ProgramDecimator::finish() {
  if (auto done = flush(); !done) return done;
  return writer_->finish();
}

}  // namespace kerf
