// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/machine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/formats/gcode/expression.h"
#include "server/formats/gcode/fault.h"

namespace kerf {

GcodeMachine::GcodeMachine(GcodeSetup setup, GcodeParameters& parameters, GcodeCanon& canon,
                           Warn warn)
    : setup_(std::move(setup)),
      parameters_(parameters),
      canon_(canon),
      warn_(std::move(warn)),
      compensation_([this](const CompensatedMove& move) { emit(move); }) {
  using namespace gcode_parameter;
  parameters_.set(kDebug, 1);
  modes_.unit_mm = setup_.unit_mm;
  const double system = parameters_.numbered(kSelectedSystem);
  modes_.system = system >= 1 && system < 10 ? static_cast<int>(system + 1e-4) : 1;
  parameters_.set(kSelectedSystem, modes_.system);
  frame_ = {system_origin(modes_.system), applied_shift(), system_rotation(modes_.system)};
  actual_ = frame_.without(at_);
}

void GcodeMachine::at_line(std::size_t file, std::size_t line) {
  file_ = file;
  line_ = line;
  calls_before_ = calls_;
  canon_.at_line(file, line);
  for (std::size_t i = 0; i < at_.size(); ++i)
    parameters_.set(gcode_parameter::kPosition + static_cast<int>(i),
                    i < 3 ? at_[i] / modes_.unit_mm : at_[i]);
}

bool GcodeMachine::execute(GcodeBlock& block) {
  reject_foreign_axes(block);
  decide_motion(block);
  set_spindle_and_feed(block);
  select_tool(block);
  execute_m(block);
  if (block.has_code(GcodeGroup::kNonModal, 40)) {
    const auto seconds = block.take('p');
    if (!seconds || *seconds < 0)
      throw GcodeFault{block.code(GcodeGroup::kNonModal)->text, "needs P with the seconds to wait"};
    CompensatedInfo info;
    info.file = file_;
    info.line = line_;
    compensation_.dwell(*seconds, info);
  }
  set_modes(block);
  execute_nonmodal(block);
  if (const GcodeCode* code = block.code(GcodeGroup::kShiftApplied)) {
    reject_compensated(*code);
    restore_shift(code->code);
  }
  move(block);
  for (const GcodeWord& word : block.words)
    if (!word.used) throw GcodeFault{word.text, "has no meaning in this block"};
  return stop(block);
}

void GcodeMachine::finish() { compensation_.flush(in_plane(linear(at_), compensation_.plane())); }

void GcodeMachine::reject_compensated(const GcodeCode& code) const {
  if (compensation_.on())
    throw GcodeFault{code.text, "cannot stand while cutter compensation is on"};
}

void GcodeMachine::reject_foreign_axes(const GcodeBlock& block) const {
  for (const char letter : kAxisLetters) {
    const GcodeWord* word = block.find(letter);
    if (word != nullptr && setup_.axes.find(letter) == std::string_view::npos)
      throw GcodeFault{word->text, "the machine " + setup_.machine_name + " has no " +
                                       word->text.front() + " axis"};
  }
}

// Which motion a block asks for, by its own code or by the one in force.
void GcodeMachine::decide_motion(const GcodeBlock& block) {
  motion_to_be_ = -1;
  const bool polar = block.has_any(kPolarLetters);
  const bool axes = block.has_any(kAxisLetters) || polar;
  if (polar && (modes_.plane != ArcPlane::kXy || block.has_any("xy")))
    throw GcodeFault{"", "polar coordinates (@ ^) belong to the plane XY and replace X and Y"};
  const GcodeCode* special = block.code(GcodeGroup::kNonModal);
  const GcodeCode* motion = block.code(GcodeGroup::kMotion);
  const bool taken = special != nullptr && takes_axis_words(special->code);
  if (taken && (special->code == 920 || special->code == 520) && (polar || !axes))
    throw GcodeFault{special->text, "needs at least one axis word, and none in polar coordinates"};
  if (motion != nullptr) {
    if (motion->code == 800) {
      if (axes && !taken) throw GcodeFault{motion->text, "ends motions; it takes no axis words"};
    } else if (taken) {
      throw GcodeFault{special->text,
                       "may not share its axis words with a motion code in one block"};
    } else if (!axes && motion->code > 30) {
      throw GcodeFault{motion->text, "needs axis words"};
    }
    motion_to_be_ = motion->code;
  } else if (!taken && axes) {
    const GcodeCode* length = block.code(GcodeGroup::kToolLength);
    const bool offset = length != nullptr && (length->code == 431 || length->code == 432);
    if (modes_.motion == 800 && !offset)
      throw GcodeFault{"", "axis words need a motion code (G0, G1, G2, G3, a cycle) in force"};
    if (length == nullptr || length->code != 431) motion_to_be_ = modes_.motion;
  } else if (!taken && block.has_any("ijk") &&
             (modes_.motion == 20 || modes_.motion == 30 ||
              (setup_.tool_axis_words && modes_.motion <= 10))) {
    motion_to_be_ = modes_.motion;
  }
  if (special == nullptr || special->code != 530) return;
  if (motion_to_be_ != 0 && motion_to_be_ != 10) throw GcodeFault{special->text, "needs G0 or G1"};
  const GcodeCode* distance = block.code(GcodeGroup::kDistance);
  if (distance != nullptr ? distance->code == 910 : modes_.incremental)
    throw GcodeFault{special->text, "cannot stand with incremental coordinates (G91)"};
}

void GcodeMachine::set_spindle_and_feed(GcodeBlock& block) {
  const auto spindle = block.take('$');
  if (spindle && *spindle != 0 && *spindle != -1)
    throw GcodeFault{block.find('$')->text, "there is one spindle only, 0"};
  if (const GcodeCode* code = block.code(GcodeGroup::kSpindleMode)) {
    modes_.surface_speed = code->code == 960;
    if (modes_.surface_speed && block.find('s') == nullptr)
      throw GcodeFault{code->text, "needs S, the speed at the surface"};
    if (modes_.surface_speed) block.take('d');
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kFeedMode)) set_feed_mode(code->code);
  if (const auto feed = block.take('f')) {
    if (*feed < 0) throw GcodeFault{block.find('f')->text, "a feed cannot be negative"};
    const GcodeCode* units = block.code(GcodeGroup::kUnits);
    if (units != nullptr && (units->code == 200) != (modes_.unit_mm != 1))
      warn_(block.find('f')->text +
            " is taken in the units before this block, as LinuxCNC does; give F after " +
            units->text);
    if (modes_.feed_mode != GcodeFeedMode::kInverseTime) {
      modes_.feed_deg = *feed;
      modes_.feed_mm = *feed * modes_.unit_mm;
    }
  }
  if (const auto speed = block.take('s')) {
    if (*speed < 0) throw GcodeFault{block.find('s')->text, "a spindle speed cannot be negative"};
    modes_.spindle_rpm = *speed;
  }
}

void GcodeMachine::set_feed_mode(int code) {
  modes_.feed_mode = code == 930   ? GcodeFeedMode::kInverseTime
                     : code == 940 ? GcodeFeedMode::kPerMinute
                                   : GcodeFeedMode::kPerRevolution;
  // A feed of one mode means nothing in another: it must be given anew.
  if (code != 930) modes_.feed_mm = modes_.feed_deg = 0;
}

void GcodeMachine::set_modes(GcodeBlock& block) {
  if (const GcodeCode* code = block.code(GcodeGroup::kPlane)) {
    const ArcPlane plane = code->code == 170   ? ArcPlane::kXy
                           : code->code == 180 ? ArcPlane::kZx
                                               : ArcPlane::kYz;
    if (plane != modes_.plane) reject_compensated(*code);
    modes_.plane = plane;
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kUnits))
    modes_.unit_mm = code->code == 200 ? kMmPerInch : 1;
  compensation_.set_unit(modes_.unit_mm);
  if (const GcodeCode* code = block.code(GcodeGroup::kCutterCompensation))
    start_compensation(block, code->code);
  if (const GcodeCode* code = block.code(GcodeGroup::kToolLength)) {
    reject_compensated(*code);
    offset_tool(block, code->code);
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kCoordinateSystem)) {
    reject_compensated(*code);
    select_system(code->code <= 590 ? code->code / 10 - 53 : code->code - 584);
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kPathControl)) {
    reject_compensated(*code);
    // How tightly corners are followed is the controller's matter: Kerf follows the programmed
    // path.
    if (code->code == 640) {
      block.take('p');
      block.take('q');
    }
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kDistance))
    modes_.incremental = code->code == 910;
  if (const GcodeCode* code = block.code(GcodeGroup::kArcDistance))
    modes_.arc_absolute = code->code == 901;
  if (const GcodeCode* code = block.code(GcodeGroup::kRetract)) {
    reject_compensated(*code);
    modes_.retract_to_r = code->code == 990;
  }
}

bool GcodeMachine::stop(const GcodeBlock& block) {
  const GcodeCode* code = block.code(GcodeGroup::kStop);
  if (code == nullptr) return false;
  compensation_.flush(in_plane(linear(at_), compensation_.plane()));
  return code->code == 2 || code->code == 30 || code->code == 99;
}

void GcodeMachine::count_call() {
  if (++calls_ > kGcodeCallsMax)
    throw GcodeFault{
        "", "the program asks for more than " + std::to_string(kGcodeCallsMax) + " motions"};
}

}  // namespace kerf
