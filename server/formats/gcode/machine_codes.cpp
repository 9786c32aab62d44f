// SPDX-License-Identifier: Apache-2.0
// M codes of GcodeMachine and the saving of its modes.
#include <cmath>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/machine.h"

namespace kerf {

void GcodeMachine::execute_m(GcodeBlock& block) {
  if (const GcodeCode* code = block.code(GcodeGroup::kInputOutput)) {
    reject_compensated(*code);
    use_input_output(block, code->code);
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kToolChange)) change_tool(block, code->code);
  if (const GcodeCode* code = block.code(GcodeGroup::kSpindle)) {
    turn_spindle(block, code->code);
    if (code->code <= 5) remark_spindle();
  } else if (block.find('s') != nullptr && modes_.spindle != GcodeSpindle::kStopped) {
    remark_spindle();
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kCoolant)) {
    if (code->code == 7) modes_.mist = true;
    if (code->code == 8) modes_.flood = true;
    if (code->code == 9) modes_.mist = modes_.flood = false;
    using Kind = MachineRemark::Kind;
    if (code->code >= 7 && code->code <= 9)
      canon_.remark({.kind = code->code == 7   ? Kind::kMist
                             : code->code == 8 ? Kind::kFlood
                                               : Kind::kCoolantOff});
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kOverride)) {
    reject_compensated(*code);
    override_speeds(block, code->code);
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kTcp)) {
    reject_compensated(*code);
    control_tool_center(tcp_by_length_code_, code->code == 428);
  }
}

void GcodeMachine::turn_spindle(GcodeBlock& block, int code) {
  switch (code) {
    case 3:
      modes_.spindle = GcodeSpindle::kClockwise;
      return;
    case 4:
      modes_.spindle = GcodeSpindle::kCounterClockwise;
      return;
    case 19:
      block.take('r');
      block.take('p');
      block.take('q');
      [[fallthrough]];
    case 5:
      modes_.spindle = GcodeSpindle::kStopped;
      return;
    case 71:
      saved_.back().modes.reset();
      return;
    case 72:
      if (!saved_.back().modes)
        throw ProgramFault{"M72", "requires modes saved with M70 or M73 at this call level"};
      return restore(*saved_.back().modes);
    default:  // 70, 73
      saved_.back().modes = modes_;
      saved_.back().compensated = compensation_.on();
      if (code == 73 && saved_.size() > 1) saved_.back().restore_on_return = true;
  }
}

void GcodeMachine::remark_spindle() {
  using Kind = MachineRemark::Kind;
  if (modes_.spindle == GcodeSpindle::kStopped) return canon_.remark({.kind = Kind::kSpindleStop});
  canon_.remark({.kind = modes_.spindle == GcodeSpindle::kClockwise
                             ? Kind::kSpindleClockwise
                             : Kind::kSpindleCounterClockwise,
                 .rpm = modes_.surface_speed ? 0 : modes_.spindle_rpm});
}

void GcodeMachine::leave_subroutine() {
  const Saved left = saved_.back();
  if (left.restore_on_return && left.modes) restore(*left.modes);
  saved_.pop_back();
  if (pocket_ && !pocket_->is_complete && saved_.size() == pocket_->depth) end_outline();
}

void GcodeMachine::restore(const GcodeModes& modes) {
  if (compensation_.on() != saved_.back().compensated) {
    if (saved_.back().compensated)
      throw ProgramFault{"", "M72 and M73 cannot restore cutter compensation"};
    GcodeBlock empty;
    start_compensation(empty, 400);
  }
  if (modes.system != modes_.system) select_system(modes.system);
  if (modes.tool_length != modes_.tool_length) {
    const ToolTableEntry* loaded = tool(loaded_tool_);
    apply_tool_offset(modes.tool_length && loaded != nullptr ? loaded->offset : GcodeAxes{});
  }
  const int motion = modes_.motion;
  modes_ = modes;
  modes_.motion = motion;
}

void GcodeMachine::override_speeds(GcodeBlock& block, int code) {
  const bool on = code == 48 || (code != 49 && block.take('p').value_or(1) != 0);
  if (code <= 50) modes_.feed_override = on;
  if (code <= 49 || code == 51) modes_.speed_override = on;
  if (code == 52) modes_.adaptive_feed = on;
  if (code == 53) modes_.feed_hold = on;
}

// Outputs have no effect on the workpiece. Reading an input leaves #5399 unchanged.
void GcodeMachine::use_input_output(GcodeBlock& block, int code) {
  const GcodeCode& written = *block.code(GcodeGroup::kInputOutput);
  const auto digital = block.take('p');
  if (code <= 65) {
    if (!digital) throw ProgramFault{written.text, "requires P, the number of the output"};
    return;
  }
  const auto analog = block.take('e');
  block.take('q');
  if (code > 66) {
    if (!analog) throw ProgramFault{written.text, "requires E, the number of the output"};
    return;
  }
  const auto wait = block.take('l');
  if (digital.has_value() == analog.has_value())
    throw ProgramFault{written.text, "requires either P or E, the number of the input"};
  warn_(written.text + " reads an input, which is not supported; #5399 keeps its value" +
        (wait.value_or(0) != 0 ? " and the program does not wait" : ""));
  const double kept = parameters_.numbered(gcode_parameter::kInput);
  if (digital) parameters_.set(gcode_parameter::kInput, kept != 0 ? 1 : 0);
}

void GcodeMachine::control_tool_center(bool by_length_code, bool by_m_code) {
  // The machine does not move. Only the coordinates of its position change.
  tcp_by_length_code_ = by_length_code;
  tcp_by_m_code_ = by_m_code;
  const GcodePlace at = canon_.control_tool_center(by_length_code || by_m_code, place(at_));
  at_ = frame_.programmed(at.axes);
  actual_ = at.axes;
}

}  // namespace kerf
