// SPDX-License-Identifier: Apache-2.0
// Pockets within an outline (G150 of Haas). The moves of a program that states the outline are
// recorded instead of made. Then the pocket is milled.
#include <cmath>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/expression.h"
#include "server/formats/gcode/machine.h"
#include "server/formats/number_text.h"

namespace kerf {
namespace {

constexpr int kProgramMax = 99'999;
constexpr std::size_t kOutlineMovesMax = 10'000;
/// Greatest distance between the ends of a closed outline.
constexpr double kClosedMm = 0.01;

ProgramFault fault(const std::string& reason) { return ProgramFault{"G150", reason}; }

std::string text_of(double x_mm, double y_mm, double unit_mm) {
  return "X" + decimal_text(x_mm / unit_mm, 6) + " Y" + decimal_text(y_mm / unit_mm, 6);
}

}  // namespace

// G41 and G42 in the block of G150 state the side of the outline. The path is compensated here.
void GcodeMachine::take_outline_side(GcodeBlock& block) {
  outline_side_ = 0;
  const GcodeCode* side = block.code(GcodeGroup::kCutterCompensation);
  if (side == nullptr || side->code == 400) return;
  if (reads_outline()) throw ProgramFault{side->text, "belongs into the block of G150"};
  if (!block.has_code(GcodeGroup::kMotion, 1500)) return;
  outline_side_ = side->code < 420 ? 1 : -1;
  block.drop(GcodeGroup::kCutterCompensation);
}

// X Y: a point in the pocket, Z: its depth, R: the height above it, Q: depth of a pass, I or J:
// distance of the strokes along X or Y, K: allowance for the finishing loop, D: the tool's radius.
void GcodeMachine::begin_outline(GcodeBlock& block) {
  if (reads_outline()) throw fault("is not allowed in the outline of another pocket");
  if (compensation_.on()) throw fault("takes G41 or G42 in its own block; program G40 before");
  if (modes_.plane != ArcPlane::kXy || std::abs(frame_.scale[0]) != 1 ||
      std::abs(frame_.scale[1]) != 1 || modes_.incremental)
    throw fault("requires the plane XY (G17), G90 and no scaling (G50)");
  if (modes_.feed_mode == GcodeFeedMode::kInverseTime)
    throw fault("is not allowed in inverse time mode (G93)");
  require_feed(block);
  const auto mm = [&](char letter) { return block.take(letter).value_or(0) * modes_.unit_mm; };
  for (const char letter : {'p', 'z', 'r', 'q'})
    if (block.find(letter) == nullptr)
      throw fault(std::string("requires ") + static_cast<char>(letter - 'a' + 'A'));
  MilledPocket pocket;
  const GcodeWord& program = *block.find('p');
  if (!is_gcode_integer(program.value) || program.value < 1 || program.value > kProgramMax)
    throw ProgramFault{program.text, "must be the number of the program that states the outline"};
  pocket.program = static_cast<int>(std::lround(program.value));
  block.take('p');
  pocket.start = at_;
  for (const char letter : {'x', 'y'})
    if (block.find(letter) != nullptr) pocket.start[letter == 'x' ? 0 : 1] = mm(letter);
  pocket.bottom = mm('z');
  pocket.top = mm('r');
  pocket.infeed = mm('q');
  pocket.finish = mm('k');
  const double i = mm('i'), j = mm('j');
  pocket.along_x = j > 0;
  pocket.step = j > 0 ? j : i;
  if (!(pocket.step > 0)) throw fault("requires I or J, the distance of the strokes, above 0");
  if (!(pocket.infeed > 0) || pocket.finish < 0)
    throw fault("requires Q, the depth of a pass, above 0 and K of at least 0");
  if (!(pocket.bottom < pocket.top)) throw fault("requires Z, the depth, below R");
  pocket.side = outline_side_;
  pocket.radius = outline_side_ == 0 ? 0 : pocket_offset_mm(block);
  pocket.speed = feed_of(block);
  pocket.depth = saved_.size();
  pocket.file = file_;
  pocket.line = line_;
  // The outline begins at the tool's position, without a motion.
  at_ = pocket.start;
  pocket_ = std::move(pocket);
}

std::optional<int> GcodeMachine::take_outline_program() {
  if (!reads_outline() || std::exchange(pocket_->is_called, true)) return std::nullopt;
  return pocket_->program;
}

// `center` of an arc. The first move leads from the start to the outline.
void GcodeMachine::record_outline(const GcodeAxes& to, std::optional<PlanePoint> center,
                                  int turns) {
  AreaPath& outline = pocket_->outline;
  if (modes_.plane != ArcPlane::kXy) throw fault("its outline must be in the plane XY (G17)");
  for (std::size_t axis = 2; axis < to.size(); ++axis)
    if (to[axis] != at_[axis]) throw fault("its outline may move X and Y only");
  if (outline.empty() && center) throw fault("the first move to the outline must be straight");
  if (std::abs(turns) > 1) throw fault("arcs of its outline must be less than a turn");
  if (outline.size() > kOutlineMovesMax)
    throw fault("its outline has more than " + std::to_string(kOutlineMovesMax) + " moves");
  const bool moves = center || to[0] != at_[0] || to[1] != at_[1];
  at_ = to;
  if (!moves && !outline.empty()) return;
  AreaMove move{.x = to[0], .y = to[1]};
  if (center) {
    move.turns = turns;
    move.center_x = center->first;
    move.center_y = center->second;
  }
  outline.push_back(move);
}

// Called when the program with the outline returns.
void GcodeMachine::end_outline() {
  MilledPocket& pocket = *pocket_;
  pocket.is_complete = true;
  at_ = frame_.programmed(actual_);
  AreaPath& outline = pocket.outline;
  if (outline.size() < 2) throw fault("the program of its outline moves along none");
  const AreaMove &first = outline.front(), &last = outline.back();
  if (std::hypot(first.x - last.x, first.y - last.y) > kClosedMm)
    throw fault("its outline is not closed: it begins at " +
                text_of(first.x, first.y, modes_.unit_mm) + " and ends at " +
                text_of(last.x, last.y, modes_.unit_mm));
  outline.back().x = first.x;
  outline.back().y = first.y;
  const double inset = pocket.radius + pocket.finish;
  const OutlinePocket& roughed = pocket.roughed.emplace(outline, inset);
  if (pocket.side != 0 && (pocket.side > 0) != roughed.is_counterclockwise())
    throw fault(std::string(pocket.side > 0 ? "G41" : "G42") +
                " is the outer side of its outline; use " + (pocket.side > 0 ? "G42" : "G41"));
  if (!roughed.is_clear({pocket.start[0], pocket.start[1]}))
    throw fault("the tool does not fit into its outline at the start, " +
                text_of(pocket.start[0], pocket.start[1], modes_.unit_mm));
  if (pocket.radius > 0 && pocket.step > 2 * pocket.radius)
    warn_once("G150", "the strokes of G150 are farther apart than the tool's diameter");
  pocket.rough_loop = roughed.loop();
  if (pocket.finish > 0)
    pocket.finish_loop = pocket.finished.emplace(outline, pocket.radius).loop();
  auto strokes = roughed.strokes(pocket.step, pocket.along_x);
  if (!strokes) throw fault(strokes.error());
  pocket.strokes = *std::move(strokes);
  for (const double level : pass_levels(pocket.top, pocket.bottom, pocket.infeed))
    pocket.levels.push_back(level);
}

void GcodeMachine::go_to_height(double height) {
  GcodeAxes to = at_;
  to[2] = height;
  rapid(to, GcodeRapid::kPlain, {false, false, true, false, false, false});
}

void GcodeMachine::go_above(const MilledPocket& pocket, OutlinePoint to) {
  if (at_[2] < pocket.top) go_to_height(pocket.top);
  GcodeAxes target = at_;
  target[0] = to.x;
  target[1] = to.y;
  if (target != at_) rapid(target, GcodeRapid::kPlain, {true, true, false, false, false, false});
  if (at_[2] > pocket.top) go_to_height(pocket.top);
}

// Moves to a point at the depth of a pass, within `area` if possible, else above the pocket. From
// above it descends at the start, where the program may have drilled a hole, if the path is free
// from there.
void GcodeMachine::go_in_pocket(const MilledPocket& pocket, const OutlinePocket& area,
                                OutlinePoint to, double level) {
  const OutlinePoint start{pocket.start[0], pocket.start[1]};
  const bool is_at_depth = at_[2] <= level + 1e-9;
  if (!is_at_depth || !area.is_clear({at_[0], at_[1]}, to)) {
    go_above(pocket, !is_at_depth && area.is_clear(start, to) ? start : to);
    GcodeAxes down = at_;
    down[2] = level;
    feed(down, pocket.speed, {false, false, true, false, false, false});
  }
  GcodeAxes target = at_;
  target[0] = to.x;
  target[1] = to.y;
  if (target != at_) feed(target, pocket.speed, {true, true, false, false, false, false});
}

void GcodeMachine::follow_loop(const MilledPocket& pocket, const OutlinePocket& area,
                               const AreaPath& loop, double level) {
  go_in_pocket(pocket, area, {loop.front().x, loop.front().y}, level);
  for (std::size_t i = 1; i < loop.size(); ++i) {
    GcodeAxes to = at_;
    to[0] = loop[i].x;
    to[1] = loop[i].y;
    if (loop[i].turns == 0) {
      feed(to, pocket.speed, {true, true, false, false, false, false});
    } else {
      circle_to(to, {loop[i].center_x, loop[i].center_y, at_[2]}, loop[i].turns, pocket.speed);
    }
  }
}

bool GcodeMachine::mill_on() {
  if (!pocket_ || !pocket_->is_complete) return false;
  MilledPocket& pocket = *pocket_;
  at_line(pocket.file, pocket.line);
  const double level = pocket.levels.front();
  follow_loop(pocket, *pocket.roughed, pocket.rough_loop, level);
  for (const OutlineStroke& stroke : pocket.strokes) {
    go_in_pocket(pocket, *pocket.roughed, stroke.from, level);
    go_in_pocket(pocket, *pocket.roughed, stroke.to, level);
  }
  pocket.levels.pop_front();
  if (!pocket.levels.empty()) return true;
  if (pocket.finished) follow_loop(pocket, *pocket.finished, pocket.finish_loop, level);
  go_to_height(pocket.top);
  pocket_.reset();
  return true;
}

}  // namespace kerf
