// SPDX-License-Identifier: Apache-2.0
// Radius compensation of SinumerikMachine: G41, G42 and G40.
#include "server/formats/control/fault.h"
#include "server/formats/sinumerik/machine.h"

namespace kerf {

void SinumerikMachine::refuse_compensated(const std::string& word) {
  require_no_corner(word);
  release_corner();
  if (compensation_.on())
    throw ProgramFault{word, "is not supported while G41 or G42 is on; program G40 before it"};
}

// The radius is that of the scene's tool, because D and the tool data are in the control.
double SinumerikMachine::tool_radius_mm(const std::string& word) const {
  std::optional<ToolId> tool = loaded_;
  if (!tool && scene_.tools.size() == 1) tool = scene_.tools.begin()->first;
  const auto found = tool ? scene_.tools.find(*tool) : scene_.tools.end();
  if (found == scene_.tools.end()) throw ProgramFault{word, "requires a loaded tool"};
  return found->second.tool.radius_mm;
}

double SinumerikMachine::offset_mm() {
  if (offsets_are_wear_) return 0;
  const double radius_mm = tool_radius_mm("G41");
  if (warned_.insert("G41").second)
    warn_(
        "G41 and G42 take the radius of the scene's tool, as the tool data of the control are "
        "not known");
  return radius_mm;
}

void SinumerikMachine::compensate(int code) {
  if (code == 40) {
    if (!compensation_.on()) return;
    require_no_corner("G40");
    release_corner();
    // The tool stays until it moves within the plane.
    beside_ = compensation_.end(in_plane(linear(frame_.programmed(at_)), plane_));
    return;
  }
  const std::string name = "G" + std::to_string(code);
  require_no_corner(name);
  release_corner();
  const int side = code == 41 ? 1 : -1;
  if (compensation_.on() && compensation_.side() == side) return;
  refuse_compensated(name);
  if (plane_ == ArcPlane::kYz) throw ProgramFault{name, "requires the plane XY (G17) or ZX (G18)"};
  if (feed_mode_ == FeedMode::kInverse)
    throw ProgramFault{name, "is not supported with feeds in inverse time (G93)"};
  compensation_.set_unit(unit_mm_);
  compensation_.start(side, offset_mm(), plane_);
  actual_ = at_;
}

// The programmed point, the base of increments and centers.
GcodeAxes SinumerikMachine::programmed() const {
  if (corner_) return corner_->at;
  GcodeAxes axes = frame_.programmed(at_);
  if (!compensation_.beside()) return axes;
  const PlanePoint point = compensation_.programmed();
  set_linear(
      axes, from_plane({point.first, point.second, in_plane(linear(axes), plane_).normal}, plane_));
  return axes;
}

CompensatedInfo SinumerikMachine::info_of(const GcodeAxes& to, const Named& named,
                                          const GcodeFeed& speed) const {
  CompensatedInfo info;
  info.axes = to;
  info.feed = speed;
  info.named = named;
  info.line = line_;
  return info;
}

void SinumerikMachine::stand_beside(const GcodeAxes& to, PlanePoint center) {
  GcodeAxes axes = to;
  set_linear(axes, from_plane(center, plane_));
  at_ = frame_.absolute(axes);
}

// A move of the tool's center, of this line or an earlier one.
void SinumerikMachine::emit(const CompensatedMove& move) {
  canon_.at_line(0, move.info.line);
  if (move.kind == CompensatedMove::Kind::kDwell) {
    canon_.dwell(move.seconds);
  } else {
    GcodeAxes to = move.info.axes;
    set_linear(to, from_plane(move.end, plane_));
    const GcodePlace end = place(to);
    if (move.kind == CompensatedMove::Kind::kRapid) {
      canon_.rapid(end, GcodeRapid::kPlain, move.info.named);
    } else if (move.kind == CompensatedMove::Kind::kFeed) {
      canon_.feed(end, move.info.feed, move.info.named);
    } else {
      canon_.arc(arc_about(linear(frame_.programmed(actual_)), linear(to), plane_, move.center,
                           move.turns),
                 frame_, end, move.info.feed, move.info.named);
    }
    actual_ = end.axes;
  }
  canon_.at_line(0, line_);
}

void SinumerikMachine::finish() {
  require_no_corner("M30");
  release_corner();
  compensation_.flush(in_plane(linear(frame_.programmed(at_)), plane_));
}

}  // namespace kerf
