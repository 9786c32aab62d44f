// SPDX-License-Identifier: Apache-2.0
// Corners of GcodeMachine: ,R rounds and ,C cuts the corner between two straight cutting moves in
// the active plane (Fanuc, Haas).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/machine.h"

namespace kerf {
namespace {

constexpr double kLevelMm = 1e-9;

}  // namespace

void GcodeMachine::require_no_corner() const {
  if (corner_)
    throw ProgramFault{"", "a corner (,R or ,C) must be followed by a straight cutting move (G1)"};
}

// Delays a move with a corner until the next move is known. Returns false without a corner.
bool GcodeMachine::begin_corner(GcodeBlock& block, const GcodeAxes& to) {
  auto radius = block.take(kCornerRadius);
  if (!radius) radius = block.take('r');  // R of G1 without the comma can only be a corner
  const auto chamfer = block.take(kCornerChamfer);
  if (!radius && !chamfer) return false;
  Corner corner{
      .at = to, .feed = feed_of(block), .named = named_axes(block), .file = file_, .line = line_};
  corner.radius_mm = radius.value_or(0) * modes_.unit_mm;
  corner.chamfer_mm = chamfer.value_or(0) * modes_.unit_mm;
  if (corner.radius_mm < 0 || corner.chamfer_mm < 0)
    throw ProgramFault{radius ? ",R" : ",C", "must not be negative"};
  if (corner.radius_mm == 0 && corner.chamfer_mm == 0) return false;
  if (modes_.feed_mode == GcodeFeedMode::kInverseTime)
    throw ProgramFault{radius ? ",R" : ",C", "is not supported in inverse time mode (G93)"};
  corner_ = corner;
  return true;
}

CompensatedInfo GcodeMachine::info_of(const Corner& corner, const GcodeAxes& to) {
  return {.axes = to,
          .feed = corner.feed,
          .named = corner.named,
          .file = corner.file,
          .line = corner.line};
}

// Makes the first line up to the corner, and the corner. The second line follows to `next`.
void GcodeMachine::cut_corner(const GcodeAxes& next) {
  const Corner corner = *corner_;
  corner_.reset();
  const ArcPlane plane = modes_.plane;
  PlanePoint a = in_plane(linear(at_), plane);
  const PlanePoint b = in_plane(linear(corner.at), plane), c = in_plane(linear(next), plane);
  if (compensation_.beside()) {
    a.first = compensation_.programmed().first;
    a.second = compensation_.programmed().second;
  }
  if (std::abs(a.normal - b.normal) > kLevelMm || std::abs(c.normal - b.normal) > kLevelMm ||
      rotary(at_) != rotary(next))
    throw ProgramFault{"", "a corner (,R or ,C) requires two moves within the active plane"};
  const double in = direction(a, b), out = direction(b, c);
  const double turn = std::remainder(out - in, 2 * std::numbers::pi);
  const double reach =
      corner.chamfer_mm > 0 ? corner.chamfer_mm : corner.radius_mm * std::abs(std::tan(turn / 2));
  if (!(reach <= std::min(distance(a, b), distance(b, c)) + kLevelMm))
    throw ProgramFault{"", "the corner (,R or ,C) is larger than one of its moves"};
  const PlanePoint start = offset_point(b, -reach, in), end = offset_point(b, reach, out);
  const auto cut_line = [&](const GcodeAxes& to) {
    if (!compensation_.active()) return feed(to, corner.feed, corner.named);
    follow_line(false, to, info_of(corner, to));
  };
  GcodeAxes to = corner.at;
  set_linear(to, from_plane(start, plane));
  cut_line(to);
  set_linear(to, from_plane(end, plane));
  if (corner.chamfer_mm > 0 || std::abs(turn) < 1e-9) return cut_line(to);
  const double side = turn > 0 ? 1 : -1;
  const PlanePoint center = offset_point(start, corner.radius_mm, in + side * std::numbers::pi / 2);
  if (compensation_.active())
    return follow_arc(to, {.ijk = from_plane(center, plane), .absolute = true}, turn < 0, 1,
                      kSpiralToleranceMm, info_of(corner, to));
  if (reads_outline()) return record_outline(to, center, turn > 0 ? 1 : -1);
  count_call();
  canon_.arc(arc_about(linear(at_), linear(to), plane, center, turn > 0 ? 1 : -1), frame_,
             place(to), corner.feed, corner.named);
  set_position(to);
}

}  // namespace kerf
