// SPDX-License-Identifier: Apache-2.0
// Tools of GcodeMachine: selection and change, tool offsets, and the start of cutter compensation.
#include <cmath>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/expression.h"
#include "server/formats/gcode/machine.h"

namespace kerf {
namespace {

constexpr int kToolNumberMax = 1'000'000'000;
// Positions nearer than this are equal. They differ by rounding.
constexpr double kSamePlaceMm = 1e-6;

int tool_integer(double value, int least, const GcodeWord& word) {
  if (!is_gcode_integer(value) || std::lround(value) < least)
    throw ProgramFault{word.text, "must be an integer from " + std::to_string(least) + " to " +
                                      std::to_string(kToolNumberMax)};
  return static_cast<int>(std::lround(value));
}

}  // namespace

const ToolTableEntry* GcodeMachine::tool(int number) const {
  const auto it = setup_.tools.find(number);
  return it == setup_.tools.end() ? nullptr : &it->second;
}

// Returns the tool of an H, D, Q or P word. 0 is the loaded tool. An empty spindle has length and
// diameter 0.
const ToolTableEntry& GcodeMachine::tool_of_word(const GcodeWord& word) const {
  static const ToolTableEntry kEmptySpindle;
  const int number = tool_integer(word.value, 0, word);
  const ToolTableEntry* entry = tool(number == 0 ? loaded_tool_ : number);
  if (entry != nullptr) return *entry;
  if (number == 0) return kEmptySpindle;
  throw ProgramFault{word.text,
                     std::string(setup_.tools_of_scene ? "the scene" : "the tool table") +
                         " has no tool " + std::to_string(number)};
}

void GcodeMachine::select_tool(GcodeBlock& block) {
  if (!block.take('t')) return;
  const GcodeWord& word = *block.find('t');
  // Macro B: a tool that is selected and never loaded need not exist.
  if (tool_integer(word.value, 0, word) != 0 && !setup_.rules.macros) tool_of_word(word);
  selected_tool_ = tool_integer(word.value, 0, word);
  if (*selected_tool_ > 0) canon_.select_tool(static_cast<ToolId>(*selected_tool_));
}

void GcodeMachine::change_tool(GcodeBlock& block, int code) {
  const GcodeCode& written = *block.code(GcodeGroup::kToolChange);
  if (code == 61) {
    if (!block.take('q'))
      throw ProgramFault{written.text, "requires Q, the number of the tool in the spindle"};
    const GcodeWord& word = *block.find('q');
    if (tool_integer(word.value, 0, word) != 0) tool_of_word(word);
    loaded_tool_ = tool_integer(word.value, 0, word);
  } else {
    reject_compensated(written);
    if (!selected_tool_ && setup_.rules.macros)
      return warn_once(written.text, written.text + " names no tool (T) and is left out");
    if (!selected_tool_) throw ProgramFault{written.text, "requires a tool selected with T"};
    loaded_tool_ = *selected_tool_;
    modes_.spindle = GcodeSpindle::kStopped;
  }
  publish_tool();
  // The machine continues from its actual position, which differs from the programmed one after
  // cutter compensation.
  const GcodeAxes actual = frame_.programmed(actual_);
  for (std::size_t i = 0; i < at_.size(); ++i)
    if (std::abs(at_[i] - actual[i]) > kSamePlaceMm) at_[i] = actual[i];
  canon_.change_tool(loaded_tool_ == 0 ? std::nullopt
                                       : std::optional(static_cast<ToolId>(loaded_tool_)));
}

void GcodeMachine::publish_tool() {
  using namespace gcode_parameter;
  const ToolTableEntry* loaded = tool(loaded_tool_);
  const ToolTableEntry entry = loaded != nullptr ? *loaded : ToolTableEntry{};
  parameters_.set(kTool, loaded_tool_);
  for (std::size_t i = 0; i < entry.offset.size(); ++i) store_axis(kToolOffset, i, entry.offset[i]);
  parameters_.set(kToolDiameter, entry.diameter_mm / setup_.machine_unit_mm);
  parameters_.set(kToolFrontAngle, entry.front_angle_deg);
  parameters_.set(kToolBackAngle, entry.back_angle_deg);
  parameters_.set(kToolOrientation, entry.orientation);
}

void GcodeMachine::offset_tool(GcodeBlock& block, int code) {
  if (code == 435 && !setup_.tool_axis_words)
    throw ProgramFault{"G43.5",
                       "requires a scene whose machine is tool-vector: I J K give the axis"};
  if (code == 435 || code == 2340) code = 434;
  control_tool_center(code == 434, tcp_by_m_code_);
  modes_.tool_length = code != 490;
  if (code == 490) return apply_tool_offset({});
  GcodeAxes offset{};
  if (code == 431 || code == 432) {
    offset = tool_offset_;
    const bool by_number = code == 432 && block.take('h').has_value();
    if (code == 432 && by_number == block.has_any(kAxisLetters))
      throw ProgramFault{"G43.2", "requires either H or axis words"};
    if (by_number) return apply_tool_offset(offset + tool_of_word(*block.find('h')).offset);
    for (std::size_t i = 0; i < offset.size(); ++i) {
      const auto value = block.take(kAxisLetters[i]);
      if (!value) continue;
      const double written = *value * (i < 3 ? modes_.unit_mm : 1);
      offset[i] = code == 431 ? written : offset[i] + written;
    }
    return apply_tool_offset(offset);
  }
  if (!block.take('h')) {
    const ToolTableEntry* loaded = tool(loaded_tool_);
    return apply_tool_offset(loaded != nullptr ? loaded->offset : GcodeAxes{});
  }
  const GcodeWord& word = *block.find('h');
  const int number = tool_integer(word.value, 0, word);
  if (setup_.tools_of_scene) {
    if (number != 0 && loaded_tool_ != 0 && loaded_tool_ != number)
      warn_(word.text + " is the length of another tool than the loaded one, T" +
            std::to_string(loaded_tool_) +
            "; without a tool table coordinates are those of the tip and lengths are not applied");
    return apply_tool_offset({});
  }
  apply_tool_offset(tool_of_word(word).offset);
}

void GcodeMachine::apply_tool_offset(const GcodeAxes& offset) {
  GcodeAxes change = tool_offset_ - offset;
  turn_xy(change[0], change[1], -frame_.rotation_deg);
  at_ = at_ + change;
  actual_ = actual_ + (tool_offset_ - offset);
  tool_offset_ = offset;
  canon_.offset_tool(offset, place(at_));
}

// G10 L1 sets an entry of the tool table. L10 and L11 set its offset so that the current position
// gets the given coordinates in the active coordinate system (L10) or in G59.3 (L11).
void GcodeMachine::set_tool_entry(GcodeBlock& block, int kind) {
  const auto number = block.take('p');
  if (!number) throw ProgramFault{"G10", "requires P, the number of the tool"};
  const GcodeWord& word = *block.find('p');
  const int tool_number = tool_integer(*number, 1, word);
  tool_of_word(word);
  ToolTableEntry& entry = setup_.tools[tool_number];
  if (!block.has_any(kAxisLetters) && !block.has_any("rqij"))
    throw ProgramFault{
        "G10", "L" + std::to_string(kind) + " requires at least one of X Y Z A B C R Q I J"};
  const GcodeAxes measured =
      kind == 1 ? GcodeAxes{} : measured_offset(block, kind == 11 ? 9 : modes_.system, entry);
  for (std::size_t i = 0; i < entry.offset.size(); ++i) {
    const auto value = block.take(kAxisLetters[i]);
    if (!value && (kind == 1 || i > 1)) continue;
    if (kind != 1) {
      entry.offset[i] = measured[i];
    } else {
      entry.offset[i] = *value * (i < 3 ? modes_.unit_mm : 1);
    }
  }
  if (const auto radius = block.take('r')) entry.diameter_mm = 2 * *radius * modes_.unit_mm;
  if (const auto angle = block.take('i')) entry.front_angle_deg = *angle;
  if (const auto angle = block.take('j')) entry.back_angle_deg = *angle;
  if (const auto orientation = block.take('q')) {
    if (*orientation > 9)
      throw ProgramFault{block.find('q')->text, "must be an orientation from 0 to 9"};
    entry.orientation = tool_integer(*orientation, 0, *block.find('q'));
  }
  publish_tool();
}

GcodeAxes GcodeMachine::measured_offset(const GcodeBlock& block, int system, ToolTableEntry entry) {
  const double turn = system_rotation(system);
  GcodeFrame frame{system_origin(system), frame_.shift, turn};
  GcodeAxes here = frame.programmed(frame_.absolute(at_) + tool_offset_);
  if (system != modes_.system) here = here + frame_.shift;
  GcodeAxes offset = entry.offset;
  turn_xy(offset[0], offset[1], -turn);
  for (std::size_t i = 0; i < offset.size(); ++i)
    if (const GcodeWord* word = block.find(kAxisLetters[i]))
      offset[i] = here[i] - word->value * (i < 3 ? modes_.unit_mm : 1);
  turn_xy(offset[0], offset[1], turn);
  return offset;
}

void GcodeMachine::start_compensation(GcodeBlock& block, int code) {
  if (code == 400) {
    if (const auto programmed = compensation_.end(in_plane(linear(at_), compensation_.plane()))) {
      const PlanePoint p = *programmed;
      // LinuxCNC returns to the path with any move, also along Z alone.
      if (setup_.rules.macros) {
        beside_ = p;
      } else {
        set_linear(at_, from_plane(p, compensation_.plane()));
      }
      arc_rejected_ = true;
    }
    return;
  }
  const GcodeCode& written = *block.code(GcodeGroup::kCutterCompensation);
  const bool repeated = compensation_.on() && (compensation_.side() > 0) == (code < 420);
  if (setup_.rules.macros && setup_.tools_of_scene && repeated) return;
  reject_compensated(written);
  if (modes_.plane == ArcPlane::kYz)
    throw ProgramFault{written.text, "requires the plane XY (G17) or ZX (G18)"};
  const auto d = block.take('d');
  int orientation = 0;
  double diameter_mm = 0;
  if (code % 10 == 1) {
    if (!d) throw ProgramFault{written.text, "requires D, the diameter"};
    diameter_mm = *d * modes_.unit_mm;
    if (const auto l = block.take('l')) orientation = tool_integer(*l, 0, *block.find('l'));
    block.take('r');
  } else if (setup_.rules.macros && setup_.tools_of_scene) {
    diameter_mm = offset_register_mm(block.find('d'));
  } else {
    static const GcodeWord kLoaded{'d', 0, "D0", true};
    const ToolTableEntry& entry = tool_of_word(d ? *block.find('d') : kLoaded);
    diameter_mm = entry.diameter_mm;
    orientation = entry.orientation;
  }
  if (orientation != 0 && orientation != 9)
    throw ProgramFault{written.text, "is not supported for a lathe tool of orientation " +
                                         std::to_string(orientation)};
  // Compensation works in programmed coordinates, and scaling does not change the tool.
  const std::size_t second = modes_.plane == ArcPlane::kXy ? 1 : 2;
  const double scale = std::abs(frame_.scale[0]);
  if (scale != std::abs(frame_.scale[second]))
    throw ProgramFault{written.text,
                       "is not supported with unequal scale factors: the tool would be an ellipse"};
  compensation_.start(code < 420 ? 1 : -1, diameter_mm / 2 / scale, modes_.plane);
}

}  // namespace kerf
