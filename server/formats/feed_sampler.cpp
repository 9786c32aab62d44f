// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/math/rotation.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/number_text.h"
#include "server/formats/pose_grid.h"
#include "server/formats/program.h"

namespace kerf {
namespace {

// A sample that would turn the axis by more than this is halved, which keeps it within the kernel's
// limit.
constexpr double kSampleTurnMaxRad = std::numbers::pi / 2;
constexpr int kSampleHalvingsMax = 20;
// Least distance by which a corner must be cut off for a warning: the default tolerance of a scene.
constexpr double kCornerWarnMm = 0.01;

// Distance of a point from a segment.
double distance_mm(Vec3 point, Vec3 from, Vec3 to) {
  const Vec3 along = to - from;
  const double square = dot(along, along);
  const double s = square > 0 ? std::clamp(dot(point - from, along) / square, 0.0, 1.0) : 0;
  return length(point - (from + along * s));
}

// A run of motions of one tool, each starting where the last one ended.
struct Chain {
  const ProgramMotion* first;
  const ProgramMotion* last;  ///< past the end
};

class ChainSampler {
 public:
  ChainSampler(Chain chain, Program& out) : chain_(chain), out_(out) {
    double end = 0;
    for (const ProgramMotion* m = chain.first; m != chain.last; ++m)
      ends_.push_back(end += m->duration_s);
    last_ = chain.first->from;
  }

  /// Greatest distance of a corner of the path from the sample that spans it, mm.
  double corner_cut_mm() const { return corner_cut_mm_; }

  void run(double rate_hz) {
    const double duration = ends_.back();
    double from = 0;
    for (std::uint64_t tick = 1; from < duration; ++tick) {
      // The last sample ends with the chain; a remainder within rounding belongs to it.
      double to = static_cast<double>(tick) / rate_hz;
      if (to >= duration * (1 - 1e-12)) to = duration;
      sample(from, to, 0);
      from = to;
    }
  }

 private:
  std::size_t motion_at(double time_s) const {
    const auto it = std::lower_bound(ends_.begin(), ends_.end(), time_s);
    return std::min(static_cast<std::size_t>(it - ends_.begin()), ends_.size() - 1);
  }

  ToolPose pose_at(double time_s) const {
    const std::size_t i = motion_at(time_s);
    const ProgramMotion& motion = chain_.first[i];
    const double start = i == 0 ? 0 : ends_[i - 1];
    const double s = std::clamp((time_s - start) / motion.duration_s, 0.0, 1.0);
    if (time_s >= ends_[i]) return motion.to;
    return admit_pose({motion.from.tip_mm + (motion.to.tip_mm - motion.from.tip_mm) * s,
                       turned_axis(motion.from.axis, motion.to.axis, s)});
  }

  void sample(double from_s, double to_s, int halvings) {
    const ToolPose to = pose_at(to_s);
    if (halvings < kSampleHalvingsMax &&
        angle_between(normalized(last_.axis), normalized(to.axis)) > kSampleTurnMaxRad) {
      const double middle = (from_s + to_s) / 2;
      sample(from_s, middle, halvings + 1);
      sample(middle, to_s, halvings + 1);
      return;
    }
    const std::size_t last = motion_at(to_s);
    for (std::size_t i = motion_at(from_s); i < last; ++i)
      corner_cut_mm_ =
          std::max(corner_cut_mm_, distance_mm(chain_.first[i].to.tip_mm, last_.tip_mm, to.tip_mm));
    const ProgramMotion& motion = chain_.first[last];
    out_.motions.push_back({.tool = motion.tool,
                            .from = last_,
                            .to = to,
                            .duration_s = to_s - from_s,
                            .line = motion.line,
                            .rapid = motion.rapid,
                            .file = motion.file});
    last_ = to;
  }

  Chain chain_;
  Program& out_;
  std::vector<double> ends_;
  ToolPose last_;
  double corner_cut_mm_ = 0;
};

void warn_of_corners(Program& sampled, double corner_cut_mm) {
  if (corner_cut_mm <= kCornerWarnMm) return;
  sampled.warnings.push_back(sampled.name + ": at this rate corners are cut off by up to " +
                             significant_text(corner_cut_mm, 3) + " mm");
}

}  // namespace

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
                  .tool_changes = program.tool_changes};
  double corner_cut_mm = 0;
  const ProgramMotion* const end = program.motions.data() + program.motions.size();
  for (const ProgramMotion* first = program.motions.data(); first != end;) {
    const ProgramMotion* last = first + 1;
    while (last != end && last->from == (last - 1)->to && last->tool == first->tool) ++last;
    ChainSampler sampler({first, last}, sampled);
    sampler.run(rate_hz);
    corner_cut_mm = std::max(corner_cut_mm, sampler.corner_cut_mm());
    first = last;
  }
  warn_of_corners(sampled, corner_cut_mm);
  return sampled;
}

}  // namespace kerf
