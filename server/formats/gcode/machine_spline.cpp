// SPDX-License-Identifier: Apache-2.0
// Splines (G5, G5.1) and rigid tapping (G33.1) of GcodeMachine.
#include <cmath>
#include <string>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/machine.h"

namespace kerf {

// G5.1 is a parabola whose control point is at I J from the start. G5 is a cubic whose first
// control point is at I J from the start, or continues the previous G5, and whose second is at P Q
// from the end.
void GcodeMachine::spline(GcodeBlock& block, bool cubic) {
  if (compensation_.on())
    throw ProgramFault{
        "", "a spline is not allowed while cutter compensation is on; program G40 first"};
  require_feed(block);
  if (modes_.plane != ArcPlane::kXy || block.has_any("zabc"))
    throw ProgramFault{"", "a spline requires the plane XY (G17) and moves X and Y only"};
  const auto i = block.take('i');
  const auto j = block.take('j');
  if (i.has_value() != j.has_value() || (!cubic && !i))
    throw ProgramFault{"", "a spline requires both I and J"};
  const bool chained = modes_.motion == 50;
  if (cubic && !i && !chained)
    throw ProgramFault{"", "the first of consecutive G5 requires I and J"};
  const double unit = modes_.unit_mm;
  const Vec3 first{at_[0] + (i ? *i * unit : spline_i_), at_[1] + (j ? *j * unit : spline_j_),
                   at_[2]};
  const auto named = named_axes(block);
  const GcodeAxes to = read_target(block);
  std::vector<Vec3> points{first, linear(to)};
  if (cubic) {
    const auto p = block.take('p');
    const auto q = block.take('q');
    if (!p || !q) throw ProgramFault{"", "G5 requires both P and Q"};
    points.insert(points.begin() + 1, Vec3{to[0] + *p * unit, to[1] + *q * unit, to[2]});
    spline_i_ = -*p * unit;
    spline_j_ = -*q * unit;
  }
  modes_.motion = cubic ? 50 : 51;
  count_call();
  canon_.spline(points, frame_, place(to), feed_of(block), named);
  set_position(to);
}

// Feeds down at pitch times spindle speed, then back to the start.
void GcodeMachine::tap(GcodeBlock& block) {
  if (compensation_.on())
    throw ProgramFault{
        "", "rigid tapping is not allowed while cutter compensation is on; program G40 first"};
  const auto pitch = block.take('k');
  if (!pitch) throw ProgramFault{"", "G33.1 requires K, the pitch"};
  if (modes_.spindle == GcodeSpindle::kStopped || modes_.spindle_rpm <= 0)
    throw ProgramFault{"", "G33.1 requires a turning spindle (M3 or M4) and a speed S above 0"};
  const double faster = std::max(1.0, block.take('i').value_or(1));
  const double feed_mm = std::abs(*pitch) * modes_.unit_mm * modes_.spindle_rpm;
  if (!(feed_mm > 0)) throw ProgramFault{block.find('k')->text, "the pitch must not be 0"};
  const auto named = named_axes(block);
  const GcodeAxes from = at_;
  const GcodeAxes to = read_target(block);
  modes_.motion = 331;
  feed(to, {.mm_per_min = feed_mm}, named);
  feed(from, {.mm_per_min = feed_mm * faster}, named);
}

}  // namespace kerf
