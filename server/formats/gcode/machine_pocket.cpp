// SPDX-License-Identifier: Apache-2.0
// Circular pockets (G12, G13) and holes on a circle (G70, G71) of GcodeMachine: additions of a Haas
// to a Fanuc, and Mach3's circles of G12 and G13.
#include <algorithm>
#include <cmath>

#include "server/formats/control/fault.h"
#include "server/formats/control/hole_pattern.h"
#include "server/formats/gcode/expression.h"
#include "server/formats/gcode/machine.h"

namespace kerf {
namespace {

constexpr int kPassesMax = 10'000;

int count_of(const GcodeWord& word, int most) {
  if (!is_gcode_integer(word.value) || word.value < 0.5 || word.value > most + 0.5)
    throw ProgramFault{word.text, "must be an integer from 1 to " + std::to_string(most)};
  return static_cast<int>(std::lround(word.value));
}

}  // namespace

void GcodeMachine::circle_to(const GcodeAxes& to, Vec3 center, int turns, const GcodeFeed& speed) {
  if (reads_outline()) return record_outline(to, in_plane(center, ArcPlane::kXy), turns);
  count_call();
  canon_.arc(
      arc_about(linear(at_), linear(to), ArcPlane::kXy, in_plane(center, ArcPlane::kXy), turns),
      frame_, place(to), speed, {true, true, false, false, false, false});
  set_position(to);
}

// A Haas reduces the circles by the tool's radius (D). Mach3's circles are those of the tool's
// center.
double GcodeMachine::pocket_offset_mm(const GcodeBlock& block) {
  if (setup_.rules.dialect == Dialect::kMach3) return 0;
  const GcodeWord* d = block.find('d');
  if (setup_.tools_of_scene || d == nullptr) return offset_register_mm(d) / 2;
  return d->value == 0 ? 0 : tool_of_word(*d).diameter_mm / 2;
}

// I: radius of the first circle, K: of the last one, Q: step between them, Z: depth, L: repeats
// (with G91, each of them deeper). The tool is at the center before and after.
void GcodeMachine::circular_pocket(GcodeBlock& block, bool clockwise) {
  const GcodeCode& written = *block.code(GcodeGroup::kMotion);
  reject_compensated(written);
  if (modes_.plane != ArcPlane::kXy || std::abs(frame_.scale[0]) != std::abs(frame_.scale[1]))
    throw ProgramFault{written.text, "requires the plane XY (G17) and equal scale factors"};
  if (modes_.feed_mode == GcodeFeedMode::kInverseTime)
    throw ProgramFault{written.text, "is not allowed in inverse time mode (G93)"};
  if (block.has_any("xy"))
    throw ProgramFault{written.text, "begins at the center: move there in the block before"};
  require_feed(block);
  const auto mm = [&](char letter) { return block.take(letter).value_or(0) * modes_.unit_mm; };
  const double first = mm('i'), step = mm('q'), last = std::max(first, mm('k'));
  const GcodeWord* repeated = block.find('l');
  const int repeats = repeated != nullptr ? count_of(*repeated, kPassesMax) : 1;
  block.take('l');
  if (!(first > 0)) throw ProgramFault{written.text, "requires I, the radius of the circle"};
  if (last > first && !((last - first) / step < kPassesMax && step > 0))
    throw ProgramFault{written.text, "requires Q, the step from I to K, above 0"};
  const double offset = pocket_offset_mm(block);
  if (first <= offset) throw ProgramFault{written.text, "I is not larger than the tool's radius"};
  if (setup_.rules.dialect == Dialect::kHaas && first - offset > offset)
    warn_once("G12", "the path from the center to the circle of " + written.text +
                         " is taken as half a circle; it cuts there, and I is more than the tool's "
                         "diameter");
  const GcodeFeed speed = feed_of(block);
  const bool straight = setup_.rules.dialect == Dialect::kMach3;
  const int turns = clockwise ? -1 : 1;
  for (int pass = 0; pass < repeats; ++pass) {
    GcodeAxes center = at_;
    if (const GcodeWord* z = block.find('z')) {
      const double depth = z->value * modes_.unit_mm;
      center[2] = modes_.incremental ? center[2] + depth : depth;
      feed(center, speed, {false, false, true, false, false, false});
    }
    const Vec3 middle = linear(center);
    double radius = first;
    while (true) {
      GcodeAxes side = center;
      side[0] += radius - offset;
      if (straight || radius > first) {
        feed(side, speed, {true, true, false, false, false, false});
      } else {
        circle_to(side, {center[0] + (radius - offset) / 2, center[1], center[2]}, turns, speed);
      }
      circle_to(side, middle, turns, speed);
      if (radius >= last) break;
      radius = std::min(radius + step, last);
    }
    if (straight) {
      feed(center, speed, {true, true, false, false, false, false});
    } else {
      circle_to(center, {center[0] + (radius - offset) / 2, center[1], center[2]}, turns, speed);
    }
  }
  block.take('z');
}

// G70 I (radius) J (first angle) L (holes) and G71 with K (angle between them): the active cycle
// drills at each point of a circle about the tool; G72 I (spacing) J (angle) L: on a line that
// begins at the tool. Returns false for other words.
bool GcodeMachine::begin_pattern(GcodeBlock& block, const GcodeCode& code) {
  const GcodeWord* count = block.find('l');
  const GcodeWord* radius = block.find('i');
  const GcodeWord* spacing = block.find('k');
  const bool circle = code.code == 700;
  if (setup_.rules.dialect != Dialect::kHaas || count == nullptr || radius == nullptr) return false;
  const bool line = code.code == 720;
  if (!circle && !line && spacing == nullptr) return false;
  const GcodeCode* motion = block.code(GcodeGroup::kMotion);
  const int cycle = motion != nullptr ? motion->code : modes_.motion;
  if (!is_canned_cycle(cycle))
    throw ProgramFault{code.text, "requires an active canned cycle (G73, G74, G81 to G89)"};
  if (modes_.plane != ArcPlane::kXy || block.has_any("xy"))
    throw ProgramFault{code.text,
                       "is supported in the plane XY, about the position of the block before"};
  const int holes = count_of(*count, kPatternHolesMax);
  const double start = block.find('j') != nullptr ? block.find('j')->value : 0;
  const double size = radius->value * modes_.unit_mm;
  for (const PatternHole& hole :
       line ? holes_on_line(holes, 0, size, start)
            : holes_on_circle(holes, size, start, circle ? 360.0 / holes : spacing->value))
    pattern_.push_back({at_[0] + hole.x, at_[1] + hole.y, 0});
  std::erase_if(block.words, [](const GcodeWord& word) {
    return std::string_view("ijkl").find(word.letter) != std::string_view::npos;
  });
  // Stores the words of a cycle in the same block, which drills at the points only.
  if (motion != nullptr) block.words.push_back({'l', 0, "L0", false, false});
  return true;
}

// Starts the active cycle at the next point of a pattern. Returns false if none is left.
bool GcodeMachine::next_of_pattern() {
  if (pattern_.empty()) return false;
  const PlanePoint at = in_plane(linear(at_), ArcPlane::kXy);
  const PlanePoint hole = pattern_.front();
  pattern_.pop_front();
  CycleWords words;
  const double first = modes_.incremental ? hole.first - at.first : hole.first;
  const double second = modes_.incremental ? hole.second - at.second : hole.second;
  words.first = first / modes_.unit_mm;
  words.second = second / modes_.unit_mm;
  GcodeBlock none;
  running_ = RunningCycle{Cycle(modes_.motion, modes_, at, words, cycle_),
                          ArcPlane::kXy,
                          {true, true, true, false, false, false},
                          feed_of(none)};
  return true;
}

}  // namespace kerf
