// SPDX-License-Identifier: Apache-2.0
// Corners of GcodeMachine: ,R rounds and ,C cuts the corner between two straight cutting moves in
// the active plane (Fanuc, Haas).
#include "server/formats/control/fault.h"
#include "server/formats/gcode/machine.h"

namespace kerf {

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
  const CornerSize size{.radius_mm = radius.value_or(0) * modes_.unit_mm,
                        .leg_mm = chamfer.value_or(0) * modes_.unit_mm};
  if (size.radius_mm < 0 || size.leg_mm < 0)
    throw ProgramFault{radius ? ",R" : ",C", "must not be negative"};
  if (size.radius_mm == 0 && size.leg_mm == 0) return false;
  if (modes_.feed_mode == GcodeFeedMode::kInverseTime)
    throw ProgramFault{radius ? ",R" : ",C", "is not supported in inverse time mode (G93)"};
  corner_ = Corner{.size = size,
                   .at = to,
                   .feed = feed_of(block),
                   .named = named_axes(block),
                   .file = file_,
                   .line = line_};
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
  const auto path = corner_path(a, b, c, corner.size);
  if (rotary(at_) != rotary(next) || (!path && path.error() == CornerFault::kNotLevel))
    throw ProgramFault{"", "a corner (,R or ,C) requires two moves within the active plane"};
  if (!path) throw ProgramFault{"", "the corner (,R or ,C) is larger than one of its moves"};
  const auto cut_line = [&](const GcodeAxes& to) {
    if (!compensation_.active()) return feed(to, corner.feed, corner.named);
    follow_line(false, to, info_of(corner, to));
  };
  GcodeAxes to = corner.at;
  set_linear(to, from_plane(path->start, plane));
  cut_line(to);
  set_linear(to, from_plane(path->end, plane));
  if (!path->center) return cut_line(to);
  if (compensation_.active())
    return follow_arc(to, {.ijk = from_plane(*path->center, plane), .absolute = true},
                      path->turns < 0, 1, kSpiralToleranceMm, info_of(corner, to));
  if (reads_outline()) return record_outline(to, path->center, path->turns);
  count_call();
  canon_.arc(arc_about(linear(at_), linear(to), plane, *path->center, path->turns), frame_,
             place(to), corner.feed, corner.named);
  set_position(to);
}

}  // namespace kerf
