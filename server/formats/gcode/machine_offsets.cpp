// SPDX-License-Identifier: Apache-2.0
// Coordinate systems of GcodeMachine. They are stored in the numbered parameters, in the machine's
// length unit and degrees.
#include <algorithm>
#include <cmath>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/expression.h"
#include "server/formats/gcode/machine.h"

namespace kerf {
namespace {

using namespace gcode_parameter;

// LinuxCNC has 9 systems, Macro B 6. Systems from 10 are the additional ones of Macro B.
int system_parameter(int system) {
  return system < 10 ? kSystem + kSystemStride * system
                     : kMoreSystemsFirst + kSystemStride * (system - 10);
}

}  // namespace

// Fanuc and Haas store and show offsets in the program's unit.
double GcodeMachine::stored_unit_mm() const {
  return setup_.rules.of_fanuc() ? modes_.unit_mm : setup_.machine_unit_mm;
}

GcodeAxes GcodeMachine::stored_axes(int first) const {
  GcodeAxes axes{};
  for (std::size_t i = 0; i < axes.size(); ++i)
    axes[i] = parameters_.numbered(first + static_cast<int>(i)) * (i < 3 ? stored_unit_mm() : 1);
  return axes;
}

// G20 and G21 convert the offsets of a Fanuc.
void GcodeMachine::convert_stored(double factor) {
  if (factor == 1 || !setup_.rules.of_fanuc()) return;
  const auto convert = [&](int first) {
    for (int axis = 0; axis < 3; ++axis)
      if (const double value = parameters_.numbered(first + axis); value != 0)
        parameters_.set(first + axis, value * factor);
  };
  for (const int first : {kHome28, kHome30, kShift}) convert(first);
  for (int system = 1; system < 10 + kMoreSystemsMax; ++system) convert(system_parameter(system));
}

void GcodeMachine::store_axis(int first, std::size_t axis, double value) {
  parameters_.set(first + static_cast<int>(axis), axis < 3 ? value / stored_unit_mm() : value);
}

GcodeAxes GcodeMachine::stored_origin(int system) const {
  return stored_axes(system_parameter(system));
}

// The origin of a system in the scene. A shop's G54 is the scene's zero, and only differences
// between offsets in machine coordinates are meaningful.
GcodeAxes GcodeMachine::system_origin(int system) const {
  const GcodeAxes stored = stored_origin(system);
  if (!zero_is_shop()) return stored;
  GcodeAxes origin{};
  for (std::size_t i = 0; i < origin.size(); ++i)
    if (zero_[i] && is_set(system, i)) origin[i] = stored[i] - *zero_[i];
  return origin;
}

bool GcodeMachine::is_set(int system, std::size_t axis) const {
  const auto known = set_systems_.find(system);
  if (known != set_systems_.end() && known->second[axis]) return true;
  return parameters_.numbered(system_parameter(system) + static_cast<int>(axis)) != 0;
}

// Before the first motion: the scene's zero is G54 if the program has set it, else the system that
// is active. From then on every change of an offset counts.
void GcodeMachine::refer_systems() {
  if (!zero_is_shop() || std::ranges::all_of(zero_, [](const auto& zero) { return !!zero; }))
    return;
  const GcodeAxes before = system_origin(modes_.system);
  for (std::size_t i = 0; i < zero_.size(); ++i) {
    if (zero_[i]) continue;
    const int system = is_set(1, i) ? 1 : modes_.system;
    zero_[i] = stored_origin(system)[i];
    if (*zero_[i] != 0)
      warn_once("zero",
                "the program sets work offsets in machine coordinates: the scene's zero is that of "
                "G54, and only differences between the offsets count");
  }
  const GcodeAxes moved = system_origin(modes_.system) - before;
  if (moved == GcodeAxes{}) return;
  GcodeFrame frame = frame_;
  frame.origin = frame.origin + moved;
  if (untransformed_) untransformed_->origin = untransformed_->origin + moved;
  change_frame(frame);
}

double GcodeMachine::system_rotation(int system) const {
  return parameters_.numbered(system_parameter(system) + kSystemRotation);
}

GcodeAxes GcodeMachine::applied_shift() const {
  return parameters_.numbered(kShiftApplied) != 0 ? stored_axes(kShift) : GcodeAxes{};
}

// The machine does not move. Only the coordinates of its position change.
void GcodeMachine::change_frame(const GcodeFrame& frame) {
  const GcodeAxes here = frame_.absolute(at_);
  frame_ = frame;
  at_ = frame_.programmed(here);
}

void GcodeMachine::select_system(int system) {
  if (system == modes_.system) return;
  modes_.system = system;
  parameters_.set(kSelectedSystem, system);
  change_frame({system_origin(system), frame_.shift, system_rotation(system)});
}

// Macro B: the program has assigned #5221 to #5326 or #7001 and following ones.
void GcodeMachine::follow_assigned_origin() {
  const GcodeAxes origin = system_origin(modes_.system);
  if (origin == frame_.origin) return;
  const std::string name = "#" + std::to_string(system_parameter(modes_.system));
  if (compensation_.on() || untransformed_)
    throw ProgramFault{name,
                       "and its neighbors hold the active work offset, which may not be assigned "
                       "while cutter compensation, rotation, scaling or a mirror image is on"};
  require_no_corner();
  change_frame({origin, frame_.shift, frame_.rotation_deg});
}

// Returns the current position in another coordinate system.
GcodeAxes GcodeMachine::in_system(int system) const {
  const GcodeFrame frame{system_origin(system), applied_shift(), system_rotation(system)};
  return frame.programmed(frame_.absolute(at_));
}

// G10 L2 sets the origin of a coordinate system. G10 L20 sets it so that the current position gets
// the given coordinates.
void GcodeMachine::set_system(GcodeBlock& block) {
  const GcodeCode& written = *block.code(GcodeGroup::kNonModal);
  const bool here = *block.take('l') == 20;
  const auto number = block.take('p');
  if (!number) throw ProgramFault{written.text, "requires P, the number of the coordinate system"};
  const int last = setup_.rules.macros ? 9 + kMoreSystemsMax : 9;
  if (!is_gcode_integer(*number) || *number < -0.5 || *number > last + 0.5)
    throw ProgramFault{block.find('p')->text,
                       "must be an integer from 0 to " + std::to_string(last)};
  const int requested = static_cast<int>(std::lround(*number));
  const int system = requested == 0 ? modes_.system : requested;
  if (system == modes_.system) reject_compensated(written);
  const GcodeAxes coordinates = in_system(system);
  const int first = system_parameter(system);
  if (!here)
    if (const auto turn = block.take('r')) parameters_.set(first + kSystemRotation, *turn);
  const double turn = system_rotation(system);
  GcodeAxes change{};
  for (std::size_t i = 0; i < change.size(); ++i) {
    const auto value = block.take(kAxisLetters[i]);
    if (!value) continue;
    const double written_value = *value * (i < 3 ? modes_.unit_mm : 1);
    set_systems_[system][i] = true;
    if (here) {
      change[i] = coordinates[i] - written_value;
    } else {
      store_axis(first, i, written_value);
    }
  }
  if (here) {
    turn_xy(change[0], change[1], turn);
    const GcodeAxes origin = system_origin(system);
    for (std::size_t i = 0; i < change.size(); ++i)
      if (change[i] != 0) store_axis(first, i, origin[i] + change[i]);
  }
  if (system != modes_.system) return;
  // Like LinuxCNC, ignores the shift of G92 here, even if the rotation changes.
  GcodeAxes at = at_;
  turn_xy(at[0], at[1], frame_.rotation_deg);
  at = at + frame_.origin - system_origin(system);
  turn_xy(at[0], at[1], -turn);
  at_ = at;
  frame_.origin = system_origin(system);
  frame_.rotation_deg = turn;
}

void GcodeMachine::shift_origin(GcodeBlock& block, int code) {
  parameters_.set(kShiftApplied, 1);
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const auto value = block.take(kAxisLetters[i]);
    if (value) {
      const double written = *value * (i < 3 ? modes_.unit_mm : 1);
      if (code == 520) {
        at_[i] += frame_.shift[i] - written;
        frame_.shift[i] = written;
      } else {
        frame_.shift[i] += at_[i] - written;
        at_[i] = written;
      }
    }
    store_axis(kShift, i, frame_.shift[i]);
  }
}

void GcodeMachine::restore_shift(int code) {
  parameters_.set(kShiftApplied, code == 923 ? 1 : 0);
  if (code == 921)
    for (std::size_t i = 0; i < at_.size(); ++i) store_axis(kShift, i, 0);
  const GcodeAxes shift = applied_shift();
  at_ = at_ + (frame_.shift - shift);
  frame_.shift = shift;
}

void GcodeMachine::save_home(int code) {
  const GcodeAxes here = frame_.absolute(at_) + tool_offset_;
  for (std::size_t i = 0; i < here.size(); ++i)
    store_axis(code == 281 ? kHome28 : kHome30, i, here[i]);
}

void GcodeMachine::execute_nonmodal(GcodeBlock& block) {
  const GcodeCode* code = block.code(GcodeGroup::kNonModal);
  if (code == nullptr || code->code == 40 || code->code == 530) return;
  if (code->code == 100) {
    const GcodeWord* kind = block.find('l');
    const int l = kind != nullptr && is_gcode_integer(kind->value)
                      ? static_cast<int>(std::lround(kind->value))
                      : -1;
    if (l == 2 || l == 20) return set_system(block);
    if (l == 1 || l == 10 || l == 11) {
      block.take('l');
      return set_tool_entry(block, l);
    }
    throw ProgramFault{code->text, "requires L1, L2, L10, L11 or L20"};
  }
  reject_compensated(*code);
  if (code->code == 280 || code->code == 300) return go_home(block, code->code);
  if (code->code == 281 || code->code == 301) return save_home(code->code);
  shift_origin(block, code->code);
}

}  // namespace kerf
