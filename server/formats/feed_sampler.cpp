#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/math/rotation.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/pose_grid.h"
#include "server/formats/program.h"

namespace kerf {
namespace {

// A sample that would turn the axis farther than this is halved, so that it stays within what the
// kernel takes.
constexpr double kSampleTurnMaxRad = std::numbers::pi / 2;
constexpr int kHalvingsMax = 20;

// A run of motions of one tool, each starting where the last one ended.
struct Chain {
  const ProgramMotion* first;
  const ProgramMotion* last;  ///< one behind
};

class ChainSampler {
 public:
  ChainSampler(Chain chain, Program& out) : chain_(chain), out_(out) {
    double end = 0;
    for (const ProgramMotion* m = chain.first; m != chain.last; ++m)
      ends_.push_back(end += m->duration_s);
    last_ = chain.first->from;
  }

  void run(double rate_hz) {
    const double duration = ends_.back();
    double from = 0;
    for (std::uint64_t tick = 1; from < duration; ++tick) {
      // The last sample ends with the chain; a rest shorter than rounding is part of it.
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
    if (halvings < kHalvingsMax &&
        angle_between(normalized(last_.axis), normalized(to.axis)) > kSampleTurnMaxRad) {
      const double middle = (from_s + to_s) / 2;
      sample(from_s, middle, halvings + 1);
      sample(middle, to_s, halvings + 1);
      return;
    }
    const ProgramMotion& motion = chain_.first[motion_at(to_s)];
    out_.motions.push_back({.tool = motion.tool,
                            .from = last_,
                            .to = to,
                            .duration_s = to_s - from_s,
                            .line = motion.line,
                            .rapid = motion.rapid});
    last_ = to;
  }

  Chain chain_;
  Program& out_;
  std::vector<double> ends_;
  ToolPose last_;
};

}  // namespace

double sample_count(const Program& program, double rate_hz) {
  double duration_s = 0;
  for (const ProgramMotion& motion : program.motions) duration_s += motion.duration_s;
  return std::ceil(duration_s * rate_hz);
}

Program sample_program(const Program& program, double rate_hz) {
  Program sampled{
      .name = program.name, .motions = {}, .warnings = program.warnings, .lines = program.lines};
  const ProgramMotion* const end = program.motions.data() + program.motions.size();
  for (const ProgramMotion* first = program.motions.data(); first != end;) {
    const ProgramMotion* last = first + 1;
    while (last != end && last->from == (last - 1)->to && last->tool == first->tool) ++last;
    ChainSampler({first, last}, sampled).run(rate_hz);
    first = last;
  }
  return sampled;
}

}  // namespace kerf
