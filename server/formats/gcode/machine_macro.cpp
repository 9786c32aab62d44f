// SPDX-License-Identifier: Apache-2.0
// Words of the controls with Macro B (Fanuc, Haas, Mach3, grbl) that LinuxCNC does not have. They
// are checked, converted to LinuxCNC's, or ignored with a warning.
#include <cmath>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/expression.h"
#include "server/formats/gcode/machine.h"

namespace kerf {
namespace {

constexpr int kFirstMoreSystem = 10;

bool has_point(const GcodeWord& word) { return word.text.find('.') != std::string::npos; }

GcodeWord* word_of(GcodeBlock& block, char letter) {
  for (GcodeWord& word : block.words)
    if (word.letter == letter) return &word;
  return nullptr;
}

void remove_words(GcodeBlock& block, std::string_view letters) {
  std::erase_if(block.words, [letters](const GcodeWord& word) {
    return letters.find(word.letter) != std::string_view::npos;
  });
}

int integer_of(const GcodeWord& word, int least, int most) {
  if (!is_gcode_integer(word.value) || word.value < least - 0.5 || word.value > most + 0.5)
    throw ProgramFault{word.text, "must be an integer from " + std::to_string(least) + " to " +
                                      std::to_string(most)};
  return static_cast<int>(std::lround(word.value));
}

}  // namespace

void GcodeMachine::warn_once(const std::string& key, const std::string& text) {
  if (warned_.insert(key).second) warn_(text);
}

void GcodeMachine::prepare(GcodeBlock& block) {
  using enum GcodeGroup;
  for (const GcodeGroup group : {kNonModal, kToolChange, kCutterCompensation, kToolLength, kUnits,
                                 kCoordinateSystem, kMoreSystems, kShiftApplied, kPlane})
    if (block.code(group) != nullptr) require_no_corner();
  prepare_units(block);
  prepare_rotation(block);
  warn_of_ambiguity(block);
  ignore_codes(block);
  ignore_power(block);
  prepare_dwell(block);
  prepare_systems(block);
  prepare_offsets(block);
  prepare_home(block);
  prepare_polar(block);
  prepare_motion(block);
  take_outline_side(block);
  // D and H are modal: they may be given before the code that uses them.
  block.take('d');
  block.take('h');
  if (setup_.changes_by_t && block.find('t') != nullptr &&
      block.code(GcodeGroup::kToolChange) == nullptr && block.find('t')->value != 0) {
    warn_once("T", "T changes the tool at once, because the program has no M6");
    block.codes.emplace_back(GcodeGroup::kToolChange, GcodeCode{6, block.find('t')->text});
  }
}

// G70 and G71 select units on some controls and, with I and L, holes on a circle on a Haas.
void GcodeMachine::prepare_units(GcodeBlock& block) {
  for (auto& [group, code] : block.codes) {
    if (group != GcodeGroup::kUnits || code.code < 700) continue;
    if (begin_pattern(block, code)) return block.drop(GcodeGroup::kUnits);
    if (code.code == 720 || block.has_any("ijl"))
      throw ProgramFault{code.text,
                         "is a pattern of holes, which is not supported; use single holes"};
    code.code = code.code == 700 ? 200 : 210;
  }
}

// G68 A B R of Mach3: the center in X and Y.
void GcodeMachine::prepare_rotation(GcodeBlock& block) const {
  if (setup_.rules.dialect != Dialect::kMach3 || !block.has_code(GcodeGroup::kRotation, 680))
    return;
  for (const auto& [written, axis] : {std::pair{'a', 'x'}, std::pair{'b', 'y'}})
    if (GcodeWord* word = word_of(block, written); word != nullptr && block.find(axis) == nullptr)
      word->letter = axis;
}

// P and E with M3, M4 and M5 set the power of spindles without speed control. Ignored.
void GcodeMachine::ignore_power(GcodeBlock& block) {
  if (block.code(GcodeGroup::kSpindle) == nullptr || block.code(GcodeGroup::kNonModal) != nullptr ||
      block.code(GcodeGroup::kMoreSystems) != nullptr || !block.has_any("pe") ||
      block_uses_cycle(block) || takes_more_systems(block))
    return;
  warn_once("M3 P", "P and E beside a spindle code are left out");
  remove_words(block, "pe");
}

// Warns of settings that the program leaves to the control.
void GcodeMachine::warn_of_ambiguity(const GcodeBlock& block) {
  unit_given_ = unit_given_ || block.code(GcodeGroup::kUnits) != nullptr;
  if (!block.has_any("xyz") || block.code(GcodeGroup::kNonModal) != nullptr) return;
  const std::string unit = modes_.unit_mm == 1 ? "mm" : "inches";
  if (!unit_given_)
    warn_once("unit",
              "the program has neither G20 nor G21 before this move: it is read in " + unit);
  if (setup_.rules.dwell_unit_s == 1) return;
  for (const GcodeWord& word : block.words)
    if (std::string_view("xyzijkr").find(word.letter) != std::string_view::npos &&
        word.value != 0 && word.text.find_first_of(".#[") == std::string::npos)
      warn_once("point", word.text + " has no decimal point: it is read in " + unit +
                             ", which a control does only with calculator input");
}

// Drops the words of codes that do not affect the path.
void GcodeMachine::ignore_codes(GcodeBlock& block) {
  bool ignored = false;
  for (const auto& [group, code] : block.codes) {
    if (group == GcodeGroup::kUnknown)
      warn_once(code.text, code.text +
                               " is taken as a code that moves nothing; its words are left "
                               "out");
    if (group == GcodeGroup::kNoEffect && code.code != 90)
      warn_once(code.text, code.text + " has no effect on the path that is carved");
    ignored = ignored || group == GcodeGroup::kUnknown ||
              (group == GcodeGroup::kNoEffect && code.code != 90 && code.code != 600);
    if (group == GcodeGroup::kNoEffect && (code.code == 220 || code.code == 230))
      remove_words(block, "xyzijk");
    if (group == GcodeGroup::kNoEffect && code.code == 600 &&
        block.code(GcodeGroup::kMotion) == nullptr) {
      block.codes.emplace_back(GcodeGroup::kMotion, GcodeCode{0, code.text});
      break;
    }
  }
  if (ignored) {
    if (takes_more_systems(block))
      throw ProgramFault{block.find('p')->text,
                         "may belong to G54 or to another code; write them in two blocks"};
    const bool keeps_p = block_uses_cycle(block) || block.code(GcodeGroup::kMoreSystems) != nullptr;
    remove_words(block, keeps_p ? "e" : "pqe");
    if (!block.has_any(kAxisLetters)) remove_words(block, "ijklr");
  }
}

bool GcodeMachine::block_uses_cycle(const GcodeBlock& block) const {
  const GcodeCode* motion = block.code(GcodeGroup::kMotion);
  return is_canned_cycle(motion != nullptr ? motion->code : modes_.motion);
}

// G4 X, U or P; P without a point counts in the control's unit.
void GcodeMachine::prepare_dwell(GcodeBlock& block) const {
  if (block.has_code(GcodeGroup::kNonModal, 40)) {
    for (const char letter : {'x', 'u'})
      if (GcodeWord* word = word_of(block, letter)) {
        word->letter = 'p';
        return;
      }
    if (word_of(block, 'p') == nullptr) block.words.push_back({'p', 0, "P", false, false});
  } else if (!block_uses_cycle(block)) {
    return;
  }
  GcodeWord* word = word_of(block, 'p');
  if (word != nullptr && !has_point(*word)) word->value *= setup_.rules.dwell_unit_s;
}

// A motion code in a block with G28 or G30 is modal only. P selects a reference point.
void GcodeMachine::prepare_home(GcodeBlock& block) {
  if (!block.has_code(GcodeGroup::kNonModal, 280) && !block.has_code(GcodeGroup::kNonModal, 300))
    return;
  remove_words(block, "p");
  const GcodeCode* motion = block.code(GcodeGroup::kMotion);
  if (motion == nullptr) return;
  if (motion->code > 30 && motion->code != 800)
    throw ProgramFault{motion->text, "is not allowed in a block with G28 or G30"};
  if (motion->code <= 30) path_motion_ = motion->code;
  modes_.motion = path_motion_;
  block.drop(GcodeGroup::kMotion);
}

// G10: L2 sets a work offset, L20 an additional one. Other tables of the control are ignored or
// rejected.
void GcodeMachine::prepare_offsets(GcodeBlock& block) {
  if (!block.has_code(GcodeGroup::kNonModal, 100)) return;
  GcodeWord* kind = word_of(block, 'l');
  GcodeWord* number = word_of(block, 'p');
  if (kind == nullptr) throw ProgramFault{"G10", "requires L"};
  const int l = integer_of(*kind, 0, 100);
  const bool grbl = setup_.rules.dialect == Dialect::kGrbl;
  if (l == 10 || l == 11 || l == 1) {
    if (!setup_.tools_of_scene)
      throw ProgramFault{kind->text,
                         "changes a tool length, which the tool table given here holds"};
    warn_once("G10 L10", "G10 " + kind->text + " sets a tool length, which is not applied");
    block.drop(GcodeGroup::kNonModal);
    return remove_words(block, "lprxyzabc");
  }
  if (l != 2 && (l != 20 || setup_.rules.dialect == Dialect::kMach3))
    throw ProgramFault{kind->text, "of G10 is not supported"};
  if (number == nullptr)
    throw ProgramFault{"G10", "requires P, the number of the coordinate system"};
  if (const GcodeWord* turn = word_of(block, 'r'))
    throw ProgramFault{turn->text, "of G10 " + kind->text + " is not supported"};
  if (!setup_.rules.of_fanuc()) {
    // Like LinuxCNC: L20 gives the current position these coordinates, P0 is the active system.
    integer_of(*number, grbl ? 0 : 1, 6);
    return;
  }
  const int p = integer_of(*number, l == 2 ? 0 : 1, l == 2 ? 6 : gcode_parameter::kMoreSystemsMax);
  if (p == 0) {
    // The external offset of a shop is part of the scene's zero. Programs clear it.
    for (const GcodeWord& word : block.words)
      if (kAxisLetters.find(word.letter) != std::string_view::npos && word.value != 0)
        throw ProgramFault{number->text, "sets the external offset, which is not supported"};
    block.drop(GcodeGroup::kNonModal);
    return remove_words(block, "lpxyzabc");
  }
  const int system = l == 2 ? p : kFirstMoreSystem + p - 1;
  kind->value = 2;
  number->value = system;
  if (!modes_.incremental && !block.has_code(GcodeGroup::kDistance, 910)) return;
  const GcodeAxes before = stored_origin(system);
  for (std::size_t i = 0; i < before.size(); ++i) {
    GcodeWord* word = word_of(block, kAxisLetters[i]);
    if (word == nullptr) continue;
    // An increment is relative to the shop's offset.
    if (!zero_[i] && !is_set(system, i)) zero_[i] = before[i];
    word->value += before[i] / (i < 3 ? modes_.unit_mm : 1);
  }
}

// Whether P of a block with G54 belongs to it.
bool GcodeMachine::takes_more_systems(const GcodeBlock& block) const {
  if (!setup_.rules.of_fanuc() || block.find('p') == nullptr || block_uses_cycle(block))
    return false;
  const GcodeCode* special = block.code(GcodeGroup::kNonModal);
  return block.has_code(GcodeGroup::kCoordinateSystem, 540) &&
         (special == nullptr || special->code == 530);
}

// G54 P, G54.1 P, G154 P, G110 to G129.
void GcodeMachine::prepare_systems(GcodeBlock& block) {
  const GcodeCode* more = block.code(GcodeGroup::kMoreSystems);
  const GcodeCode* six = block.code(GcodeGroup::kCoordinateSystem);
  int system = 0;
  if (more != nullptr && more->code >= 1100 && more->code <= 1290) {
    system = kFirstMoreSystem + more->code / 10 - 110;
  } else if (more != nullptr) {
    const GcodeWord* number = word_of(block, 'p');
    if (number == nullptr)
      throw ProgramFault{more->text, "requires P, the number of the coordinate system"};
    system = kFirstMoreSystem + integer_of(*number, 1, gcode_parameter::kMoreSystemsMax) - 1;
    remove_words(block, "p");
  } else if (six != nullptr && takes_more_systems(block)) {
    more = six;
    system = kFirstMoreSystem +
             integer_of(*word_of(block, 'p'), 1, gcode_parameter::kMoreSystemsMax) - 1;
    remove_words(block, "p");
  } else if (six != nullptr) {
    if (six->code > 590) throw ProgramFault{six->text, "is not a code of this control"};
    system = six->code / 10 - 53;
  }
  if (system == 0) return;
  if (untransformed_ && system != modes_.system)
    throw ProgramFault{more != nullptr ? more->text : six->text,
                       "is not allowed while the program is rotated, scaled or mirrored"};
  if (more != nullptr) {
    if (system != modes_.system) reject_compensated(*more);
    select_system(system);
    if (more == six) block.drop(GcodeGroup::kCoordinateSystem);
  }
  systems_.insert(system);
  const GcodeAxes offset = stored_origin(system);
  if (systems_.size() > 1 && !setup_.machine_zero_known && offset == GcodeAxes{})
    warn_once("systems",
              "uses several work offsets: without a parameter file each of them is at the scene's "
              "origin");
}

// G16: X is a radius and Y an angle about the work zero, in the plane XY.
void GcodeMachine::prepare_polar(GcodeBlock& block) {
  if (const GcodeCode* code = block.code(GcodeGroup::kPolar)) polar_ = code->code == 160;
  if (!polar_ || block.code(GcodeGroup::kNonModal) != nullptr) return;
  if (!block.has_any("xy")) return;
  const GcodeCode* plane = block.code(GcodeGroup::kPlane);
  if (plane != nullptr ? plane->code != 170 : modes_.plane != ArcPlane::kXy)
    throw ProgramFault{"G16", "polar coordinates are supported in the plane XY (G17) only"};
  const GcodeCode* distance = block.code(GcodeGroup::kDistance);
  const bool incremental = distance != nullptr ? distance->code == 910 : modes_.incremental;
  if (incremental && word_of(block, 'x') != nullptr)
    throw ProgramFault{word_of(block, 'x')->text, "an incremental polar radius is not supported"};
  if (GcodeWord* radius = word_of(block, 'x')) radius->letter = '@';
  if (GcodeWord* angle = word_of(block, 'y')) angle->letter = '^';
}

// The motion of the block: G53 is a rapid of its block only, K repeats a cycle.
void GcodeMachine::prepare_motion(GcodeBlock& block) {
  const GcodeCode* motion = block.code(GcodeGroup::kMotion);
  if (motion != nullptr && motion->code <= 30) path_motion_ = motion->code;
  block_is_machine_ = false;
  if (block.has_code(GcodeGroup::kNonModal, 530)) {
    if (motion != nullptr && motion->code != 0 && motion->code != 10 && motion->code != 800)
      throw ProgramFault{motion->text, "is not allowed in a block with G53"};
    block_is_machine_ = motion == nullptr || motion->code != 0;
    block.drop(GcodeGroup::kMotion);
    block.codes.emplace_back(GcodeGroup::kMotion, GcodeCode{0, "G53"});
    return;
  }
  if (!block_uses_cycle(block)) return;
  // K of Haas is the least peck of I, J and K; L repeats.
  const int cycle = motion != nullptr ? motion->code : modes_.motion;
  if (setup_.rules.dialect == Dialect::kHaas && (cycle == 730 || cycle == 830)) return;
  GcodeWord* repeats = word_of(block, 'k');
  if (repeats != nullptr && word_of(block, 'l') == nullptr && is_gcode_integer(repeats->value))
    repeats->letter = 'l';
}

// D refers to a radius outside the program. Without a tool table the tool's own radius is used.
double GcodeMachine::offset_register_mm(const GcodeWord* d) {
  if (d != nullptr && integer_of(*d, 0, 999) == 0) return 0;
  if (setup_.offsets_are_wear) return 0;
  const ToolTableEntry* loaded = tool(loaded_tool_);
  if (loaded == nullptr) {
    if (setup_.tools.size() != 1)
      throw ProgramFault{d != nullptr ? d->text : "", "cutter compensation requires a loaded tool"};
    loaded = &setup_.tools.begin()->second;
  }
  warn_once("D",
            "cutter compensation takes the radius of the scene's tool, because the offset "
            "registers (D) of the control are not known; a tool table gives them");
  return loaded->diameter_mm;
}

// Sets #4001 to #4130, #5001 and #5041, the control's state as macros read it.
void GcodeMachine::publish_macro_variables() {
  using namespace gcode_parameter;
  const auto set = [this](int group, double value) { parameters_.set(kModal + group, value); };
  set(1, path_motion_ / 10.0);
  set(2, modes_.plane == ArcPlane::kXy ? 17 : modes_.plane == ArcPlane::kZx ? 18 : 19);
  set(3, modes_.incremental ? 91 : 90);
  set(5, modes_.feed_mode == GcodeFeedMode::kInverseTime ? 93
         : modes_.feed_mode == GcodeFeedMode::kPerMinute ? 94
                                                         : 95);
  set(6, modes_.unit_mm == 1 ? 21 : 20);
  set(7, !compensation_.on() ? 40 : compensation_.side() > 0 ? 41 : 42);
  set(8, modes_.tool_length ? 43 : 49);
  set(9, is_canned_cycle(modes_.motion) ? modes_.motion / 10.0 : 80);
  set(10, modes_.retract_to_r ? 99 : 98);
  set(14, modes_.system < kFirstMoreSystem ? 53 + modes_.system : 54.1);
  set(109, modes_.feed_deg);
  set(119, modes_.spindle_rpm);
  set(120, selected_tool_.value_or(0));
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const double value = i < 3 ? at_[i] / modes_.unit_mm : at_[i];
    parameters_.set(kMacroEnd + static_cast<int>(i), value);
    parameters_.set(kMacroPosition + static_cast<int>(i), value);
  }
}

}  // namespace kerf
