// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/machine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/expression.h"
#include "server/formats/units.h"

namespace kerf {

GcodeMachine::GcodeMachine(GcodeSetup setup, GcodeParameters& parameters, GcodeCanon& canon,
                           Warn warn)
    : setup_(std::move(setup)),
      parameters_(parameters),
      canon_(canon),
      warn_(std::move(warn)),
      compensation_([this](const CompensatedMove& move) { emit(move); },
                    setup_.rules.of_fanuc() ? CompensationEntry::kAcrossNext
                                            : CompensationEntry::kAcrossEntry) {
  using namespace gcode_parameter;
  parameters_.set(kDebug, 1);
  modes_.unit_mm = setup_.unit_mm;
  const double system = parameters_.numbered(kSelectedSystem);
  modes_.system = system >= 1 && system < 10 ? static_cast<int>(system + 1e-4) : 1;
  parameters_.set(kSelectedSystem, modes_.system);
  if (setup_.rules.macros) modes_.motion = path_motion_;
  modes_.arc_absolute = setup_.absolute_centers;
  cycle_.lenient = setup_.rules.macros;
  cycle_.levels = setup_.rules.of_fanuc();
  modes_.retract_to_r = setup_.rules.retract_to_r;
  frame_ = {system_origin(modes_.system), applied_shift(), system_rotation(modes_.system)};
  actual_ = frame_.absolute(at_);
}

void GcodeMachine::at_line(std::size_t file, std::size_t line) {
  file_ = file;
  line_ = line;
  calls_before_ = calls_;
  canon_.at_line(file, line);
  if (parameters_.tool_life_read())
    warn_once("life", "the program asks for the use of its tools, which counts as 0: they are new");
  if (setup_.rules.macros) return publish_macro_variables();
  for (std::size_t i = 0; i < at_.size(); ++i)
    parameters_.set(gcode_parameter::kPosition + static_cast<int>(i),
                    i < 3 ? at_[i] / modes_.unit_mm : at_[i]);
}

void GcodeMachine::begin(GcodeBlock& block) {
  modal_motion_ = modes_.motion;
  if (setup_.rules.macros) {
    follow_assigned_origin();
    prepare(block);
  }
  reject_foreign_axes(block);
  decide_motion(block);
  set_spindle_and_feed(block);
  select_tool(block);
  execute_m(block);
  if (block.has_code(GcodeGroup::kNonModal, 40)) {
    const auto seconds = block.take('p');
    if (!seconds || *seconds < 0)
      throw ProgramFault{block.code(GcodeGroup::kNonModal)->text,
                         "requires P, the dwell in seconds, of at least 0"};
    CompensatedInfo info;
    info.file = file_;
    info.line = line_;
    compensation_.dwell(*seconds, info);
  }
  set_modes(block);
  if (setup_.rules.macros) transform(block);
  execute_nonmodal(block);
  if (const GcodeCode* code = block.code(GcodeGroup::kShiftApplied)) {
    reject_compensated(*code);
    restore_shift(code->code);
  }
  if (block_motion_ >= 0 && block_motion_ != 10) require_no_corner();
  move(block);
}

bool GcodeMachine::end(const GcodeBlock& block) {
  if (block_is_machine_) modes_.motion = modal_motion_;
  for (const GcodeWord& word : block.words)
    if (!word.used) throw ProgramFault{word.text, "is not used by any code of this block"};
  return stop(block);
}

void GcodeMachine::finish() {
  require_no_corner();
  if (reads_outline()) throw ProgramFault{"G150", "the program that states the outline has no M99"};
  compensation_.flush(in_plane(linear(at_), compensation_.plane()));
}

void GcodeMachine::reject_compensated(const GcodeCode& code) const {
  if (compensation_.on())
    throw ProgramFault{code.text,
                       "is not allowed while cutter compensation is on; program G40 first"};
}

void GcodeMachine::reject_foreign_axes(const GcodeBlock& block) const {
  for (const char letter : kAxisLetters) {
    const GcodeWord* word = block.find(letter);
    if (word != nullptr && setup_.axes.find(letter) == std::string_view::npos)
      throw ProgramFault{word->text, "the machine " + setup_.machine_name + " has no " +
                                         word->text.front() + " axis"};
  }
}

// Sets block_motion_ from the block's motion code or, if it has none, from the active one.
void GcodeMachine::decide_motion(const GcodeBlock& block) {
  block_motion_ = -1;
  const bool polar = block.has_any(kPolarLetters);
  const bool axes = block.has_any(kAxisLetters) || polar;
  if (polar && (modes_.plane != ArcPlane::kXy || block.has_any("xy")))
    throw ProgramFault{"",
                       "polar coordinates (@ ^) require the plane XY (G17) and exclude X and Y"};
  const GcodeCode* special = block.code(GcodeGroup::kNonModal);
  const GcodeCode* motion = block.code(GcodeGroup::kMotion);
  const bool uses_axis_words = special != nullptr && takes_axis_words(special->code);
  if (uses_axis_words && (special->code == 920 || special->code == 520) && (polar || !axes))
    throw ProgramFault{special->text,
                       "requires at least one axis word and does not take polar coordinates"};
  if (motion != nullptr) {
    if (motion->code == 800 && setup_.rules.macros) {
      block_motion_ = axes && !uses_axis_words ? path_motion_ : 800;
      return;
    }
    if (motion->code == 800) {
      if (axes && !uses_axis_words)
        throw ProgramFault{motion->text, "cancels the motion mode and takes no axis words"};
    } else if (uses_axis_words) {
      throw ProgramFault{special->text,
                         "uses the axis words of its block, which must not have a motion code"};
    } else if (!axes && motion->code > 30 && !setup_.rules.macros) {
      throw ProgramFault{motion->text, "requires axis words"};
    }
    block_motion_ = motion->code;
  } else if (!uses_axis_words && axes) {
    const GcodeCode* length = block.code(GcodeGroup::kToolLength);
    const bool offset = length != nullptr && (length->code == 431 || length->code == 432);
    if (modes_.motion == 800 && !offset)
      throw ProgramFault{"", "axis words require an active motion code (G0, G1, G2, G3, a cycle)"};
    if (length == nullptr || length->code != 431) block_motion_ = modes_.motion;
  } else if (!uses_axis_words && block.has_any("ijk") &&
             (modes_.motion == 20 || modes_.motion == 30 ||
              (setup_.tool_axis_words && modes_.motion <= 10))) {
    block_motion_ = modes_.motion;
  }
  if (special == nullptr || special->code != 530) return;
  if (block_motion_ != 0 && block_motion_ != 10)
    throw ProgramFault{special->text, "requires G0 or G1"};
  if (setup_.rules.macros) return;
  const GcodeCode* distance = block.code(GcodeGroup::kDistance);
  if (distance != nullptr ? distance->code == 910 : modes_.incremental)
    throw ProgramFault{special->text, "requires absolute coordinates (G90)"};
}

void GcodeMachine::set_spindle_and_feed(GcodeBlock& block) {
  const auto spindle = block.take('$');
  if (spindle && *spindle != 0 && *spindle != -1)
    throw ProgramFault{block.find('$')->text,
                       "selects a spindle that does not exist; the only one is 0"};
  if (const GcodeCode* code = block.code(GcodeGroup::kSpindleMode)) {
    modes_.surface_speed = code->code == 960;
    if (modes_.surface_speed && block.find('s') == nullptr)
      throw ProgramFault{code->text, "requires S, the surface speed"};
    if (modes_.surface_speed) block.take('d');
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kFeedMode)) set_feed_mode(code->code);
  if (const auto feed = block.take('f')) {
    if (*feed < 0) throw ProgramFault{block.find('f')->text, "the feed must not be negative"};
    const GcodeCode* units = block.code(GcodeGroup::kUnits);
    if (units != nullptr && (units->code == 200) != (modes_.unit_mm != 1))
      warn_(block.find('f')->text +
            " is read in the units before this block, as in LinuxCNC; give F in a block after " +
            units->text);
    if (modes_.feed_mode != GcodeFeedMode::kInverseTime) {
      modes_.feed_deg = *feed;
      modes_.feed_mm = *feed * modes_.unit_mm;
    }
  }
  if (const auto speed = block.take('s')) {
    if (*speed < 0)
      throw ProgramFault{block.find('s')->text, "the spindle speed must not be negative"};
    modes_.spindle_rpm = *speed;
  }
}

void GcodeMachine::set_feed_mode(int code) {
  const GcodeFeedMode before = modes_.feed_mode;
  modes_.feed_mode = code == 930   ? GcodeFeedMode::kInverseTime
                     : code == 940 ? GcodeFeedMode::kPerMinute
                                   : GcodeFeedMode::kPerRevolution;
  if (setup_.rules.macros && modes_.feed_mode == before) return;
  // The feed of one mode is invalid in another, so it must be programmed again.
  if (code != 930) modes_.feed_mm = modes_.feed_deg = 0;
}

void GcodeMachine::require_feed(const GcodeBlock& block) const {
  if (modes_.feed_mode == GcodeFeedMode::kInverseTime) {
    if (block.find('f') == nullptr || block.find('f')->value <= 0)
      throw ProgramFault{
          "", "in inverse time mode (G93) every cutting block requires its own F above 0"};
    return;
  }
  if (modes_.feed_deg <= 0)
    throw ProgramFault{"", "the feed is 0; give F before the first cutting motion"};
  if (modes_.feed_mode != GcodeFeedMode::kPerRevolution) return;
  if (modes_.spindle_rpm <= 0)
    throw ProgramFault{"", "feed per revolution (G95) requires a spindle speed S above 0"};
  if (modes_.surface_speed)
    throw ProgramFault{"",
                       "feed per revolution (G95) with constant surface speed (G96) is for lathes "
                       "and not supported; use G97"};
}

GcodeFeed GcodeMachine::feed_of(const GcodeBlock& block) const {
  if (modes_.feed_mode == GcodeFeedMode::kInverseTime)
    return {.duration_s = 60 / block.find('f')->value};
  const double turns = modes_.feed_mode == GcodeFeedMode::kPerRevolution ? modes_.spindle_rpm : 1;
  return {.mm_per_min = modes_.feed_mm * turns, .deg_per_min = modes_.feed_deg * turns};
}

void GcodeMachine::set_modes(GcodeBlock& block) {
  if (const GcodeCode* code = block.code(GcodeGroup::kPlane)) {
    const ArcPlane plane = code->code == 170   ? ArcPlane::kXy
                           : code->code == 180 ? ArcPlane::kZx
                                               : ArcPlane::kYz;
    if (plane != modes_.plane) reject_compensated(*code);
    modes_.plane = plane;
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kUnits)) {
    const double unit_mm = code->code == 200 ? kMmPerInch : 1;
    convert_stored(modes_.unit_mm / unit_mm);
    modes_.unit_mm = unit_mm;
  }
  compensation_.set_unit(modes_.unit_mm);
  if (const GcodeCode* code = block.code(GcodeGroup::kCutterCompensation))
    start_compensation(block, code->code);
  if (const GcodeCode* code = block.code(GcodeGroup::kToolLength)) {
    reject_compensated(*code);
    offset_tool(block, code->code);
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kCoordinateSystem)) {
    const int system = code->code <= 590 ? code->code / 10 - 53 : code->code - 584;
    if (!setup_.rules.macros || system != modes_.system) reject_compensated(*code);
    select_system(system);
  }
  if (const GcodeCode* code = block.code(GcodeGroup::kPathControl)) {
    reject_compensated(*code);
    // Path tolerances have no effect: the programmed path is followed exactly.
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
  require_no_corner();
  compensation_.flush(in_plane(linear(at_), compensation_.plane()));
  using Kind = MachineRemark::Kind;
  if (code->code <= 1) canon_.remark({.kind = code->code == 0 ? Kind::kStop : Kind::kOptionalStop});
  return code->code == 2 || code->code == 30 || code->code == 99;
}

void GcodeMachine::count_call() {
  if (++calls_ > kGcodeCallsMax)
    throw ProgramFault{
        "", "the program exceeds the limit of " + std::to_string(kGcodeCallsMax) + " motions"};
}

}  // namespace kerf
