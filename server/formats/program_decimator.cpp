// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_decimator.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/rotation.h"
#include "server/formats/arc_fit.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/number_text.h"
#include "server/formats/program_writing.h"

namespace kerf {
namespace {

/// Most poses of one joined motion. Every new motion is compared with all of them.
constexpr std::size_t kPosesMax = 128;
/// Fewer poses do not define an arc.
constexpr std::size_t kArcPosesMin = 4;

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
  const bool follows = !parts_.empty() && !rests && parts_.back().tool == motion.tool &&
                       parts_.back().rapid == motion.rapid && parts_.back().to == motion.from &&
                       path_.size() < kPosesMax;
  if (!follows) {
    if (auto done = flush(); !done) return done;
    if (rests) return writer_->add(motion);
    start(motion);
    return {};
  }
  const bool line = line_ && fits(motion.to);
  path_.push_back(motion.to);
  std::optional<FittedArc> arc;
  bool perhaps_arc = perhaps_arc_;
  if (perhaps_arc && path_.size() >= kArcPosesMin) {
    arc = fit_arc(path_, tolerance_mm_);
    perhaps_arc = arc && writer_->takes(*arc);
  }
  if (!line && !perhaps_arc) {
    if (auto done = write_first(); !done) return done;
    if (!parts_.empty()) return add(motion);
    start(motion);
    return {};
  }
  line_ = line;
  perhaps_arc_ = perhaps_arc;
  arc_ = arc;
  parts_.push_back(motion);
  return {};
}

void ProgramDecimator::start(const ProgramMotion& motion) {
  parts_ = {motion};
  path_ = {motion.from, motion.to};
  line_ = true;
  perhaps_arc_ = !motion.rapid;
  arc_.reset();
}

// Writes the parts as a line or an arc, or only the first of them if they are neither.
WriteResult ProgramDecimator::write_first() {
  ProgramMotion joined = parts_.front();
  if (!line_ && !arc_) {
    const ProgramMotion next = parts_[1];
    start(next);
    return writer_->add(joined);
  }
  joined.to = parts_.back().to;
  joined.duration_s = 0;
  for (const ProgramMotion& part : parts_) joined.duration_s += part.duration_s;
  parts_.clear();
  return line_ ? writer_->add(joined) : writer_->add_arc(joined, *arc_);
}
/// Whether the straight motion to `end` stays within the tolerance of all poses of the path and of
/// the poses halfway between them, where great circles deviate most.
bool ProgramDecimator::fits(const ToolPose& end) const {
  const double reach = reach_mm(scene_, parts_.front().tool);
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
  while (!parts_.empty())
    if (WriteResult written = write_first(); !written) return written;
  return {};
}

bool ProgramDecimator::drills(const DrilledHole& hole) const { return writer_->drills(hole); }

WriteResult ProgramDecimator::add_hole(const ProgramMotion& first, const DrilledHole& hole) {
  if (WriteResult flushed = flush(); !flushed) return flushed;
  return writer_->add_hole(first, hole);
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
