// SPDX-License-Identifier: Apache-2.0
// Cycles of KlartextMachine: holes, dwells and the cycles that shift and rotate coordinates.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "server/formats/heidenhain/machine.h"
#include "server/formats/letter_case.h"

namespace kerf {

void KlartextMachine::cycle_definition(const std::string& text) {
  std::size_t end = 0;
  while (end < text.size() && (is_digit(text[end]) || text[end] == '.')) ++end;
  const std::string number = text.substr(0, end);
  const std::string rest = text.substr(end);
  const int cycle = number.empty() ? 0 : std::atoi(number.c_str());
  const bool title = number.ends_with(".0");
  if (cycle == 7 || cycle == 10 || cycle == 9 || cycle == 19) {
    if (title) return;
    if (cycle == 19) return working_plane(klartext_words(rest));
    if (cycle == 7) return datum_shift(klartext_words(rest));
    if (cycle == 10) return rotate(klartext_words(rest));
    for (const KlartextWord& word : klartext_words(rest))  // DWELL 1.5, V.ZEIT 1.5
      if (word.value.find_first_of("0123456789Q") != std::string::npos)
        path_.dwell(std::max(0.0, values_.of(word.value)));
    return;
  }
  if (cycle == 1) return old_pecking(number, rest);
  const bool pattern = cycle == 220 || cycle == 221;
  const bool holes = cycle == 200 || cycle == 201 || cycle == 202 || cycle == 203 || cycle == 205 ||
                     cycle == 206 || cycle == 207 || cycle == 209 || cycle == 240 || cycle == 241;
  if (!holes && !pattern && !is_area_cycle(cycle))
    throw ProgramFault{"CYCL DEF " + number,
                       "is not supported; 1, 7, 9, 10, 19 without angles, 32, 200 to 203, 205 to "
                       "207, 209, 220, 221, 240, 241, 247, 251 to 254, 256 and 257 are: post the "
                       "motions of others as L and C"};
  const std::map<std::string, double> given = cycle_parameters(rest);
  if (pattern) return call_pattern(cycle, given);
  cycle_ = given;
  for (const char* needed : {"Q200", "Q201", "Q203"})
    if (!cycle_.contains(needed))
      throw ProgramFault{"CYCL DEF " + number, std::string("requires ") + needed};
  if (cycle == 240 && cycle_.contains("Q343") && cycle_["Q343"] != 0)
    throw ProgramFault{"Q343", "selects a depth by the diameter, which is not supported"};
  cycle_number_ = cycle;
  cycle_modal_ = false;
}

// "Q200=2 ;SET-UP CLEARANCE …": words such as FMAX and AUTO have no value.
std::map<std::string, double> KlartextMachine::cycle_parameters(const std::string& text) {
  std::map<std::string, double> given;
  for (std::size_t at = text.find('Q'); at != std::string::npos; at = text.find('Q', at + 1)) {
    std::size_t stop = at + 1;
    while (stop < text.size() && is_digit(text[stop])) ++stop;
    const std::string name = text.substr(at, stop - at);
    while (stop < text.size() && text[stop] == ' ') ++stop;
    if (name.size() < 2 || stop >= text.size() || text[stop] != '=') continue;
    const std::size_t from = text.find_first_not_of(' ', stop + 1);
    if (from == std::string::npos) continue;
    const std::string value = text.substr(from, text.find(' ', from) - from);
    if (value.find_first_of("0123456789Q") == std::string::npos) continue;
    std::string plain = value;
    std::ranges::replace(plain, ',', '.');
    given[name] = values_.of(plain);
    values_.set(name, given[name]);
    at = from;
  }
  return given;
}

double KlartextMachine::cycle_value(const char* name, double missing) const {
  const auto it = cycle_.find(name);
  return it == cycle_.end() ? missing : it->second;
}

// M99, M89 and CYCL CALL: the cycle at the current position. `raised_mm` shifts its surface.
void KlartextMachine::call_cycle(double raised_mm) {
  if (cycle_number_ == 0) throw ProgramFault{"M99", "calls a cycle that is not defined"};
  refuse_in_corner("M99");
  if (path_.is_compensated())
    throw ProgramFault{"M99", "while RL or RR is on is not supported; program R0 before it"};
  refuse_off_axis("CYCL DEF " + std::to_string(cycle_number_));
  if (is_area_cycle(cycle_number_)) {
    mill_area(raised_mm);
  } else {
    drill(raised_mm);
  }
}

// Drills at the current position, down to Q203 + Q201 and up to the second clearance Q204.
void KlartextMachine::drill(double raised_mm) {
  const auto value = [this](const char* name, double missing) {
    return cycle_value(name, missing);
  };
  const double set_up = value("Q200", 0) * unit_mm_;
  // Cycle 1 is relative to the tool's position.
  const double surface =
      cycle_number_ == 1 ? path_.position().z - set_up : value("Q203", 0) * unit_mm_ + raised_mm;
  const double clearance = surface + set_up;
  const double high = std::max(clearance, surface + value("Q204", 0) * unit_mm_);
  const double bottom = surface + value("Q201", 0) * unit_mm_;
  const double plunge = value("Q206", feed_.value_or(0) / unit_mm_) * unit_mm_;
  const bool taps = cycle_number_ == 206 || cycle_number_ == 207 || cycle_number_ == 209;
  const double feed = plunge > 0 ? plunge : taps ? feed_.value_or(1000) : 0;
  if (!(feed > 0)) throw ProgramFault{"Q206", "requires a feed above 0"};
  if (bottom > clearance) throw ProgramFault{"Q201", "is a depth above the clearance"};
  Vec3 at = path_.position();
  const std::array named{false, false, true};
  at.z = clearance;
  move(at, std::nullopt, named);
  at.z = bottom;
  move(at, feed, named);
  const double seconds = value("Q211", 0);
  if (seconds > 0) path_.dwell(seconds);
  at.z = high;
  move(at, std::nullopt, named);
}

// Cycle 1, pecking: 1.1 set-up clearance, 1.2 depth, 1.3 peck, 1.4 dwell, 1.5 feed, whose words
// depend on the language of the control.
void KlartextMachine::old_pecking(const std::string& number, const std::string& rest) {
  const std::size_t digits = rest.find_first_of("+-.0123456789Q");
  if (number == "1.0") {
    cycle_.clear();
    cycle_number_ = 1;
    cycle_modal_ = false;
    return;
  }
  if (digits == std::string::npos) throw ProgramFault{"CYCL DEF " + number, "requires a number"};
  std::string plain = rest.substr(digits, rest.find(' ', digits) - digits);
  std::ranges::replace(plain, ',', '.');
  const double value = values_.of(plain);
  if (number == "1.1") cycle_["Q200"] = std::abs(value);
  if (number == "1.2") cycle_["Q201"] = -std::abs(value);
  if (number == "1.4") cycle_["Q211"] = value;
  if (number == "1.5") cycle_["Q206"] = value;
}

// Cycle 19 without angles, or with angles of 0, is PLANE RESET.
void KlartextMachine::working_plane(const Words& words) {
  for (const KlartextWord& word : words)
    if (!word.value.empty() && values_.of(word.value) != 0)
      throw ProgramFault{"CYCL DEF 19",
                         "tilts the plane, which is not supported; use PLANE SPATIAL"};
  reset_plane();
}

void KlartextMachine::datum_shift(const Words& words) {
  KlartextFrame& frame = path_.changing_frame();
  if (frame.is_tilted)
    throw ProgramFault{"CYCL DEF 7", "in a tilted plane is not supported; shift before PLANE"};
  for (const KlartextWord& word : words) {
    const bool incremental = word.name.size() == 2 && word.name[0] == 'I';
    const char axis = word.name.empty() ? ' ' : word.name.back();
    if (axis == '#') throw ProgramFault{"#", "names a datum table, which is not known here"};
    double* const part = axis == 'X'   ? &frame.datum_mm.x
                         : axis == 'Y' ? &frame.datum_mm.y
                         : axis == 'Z' ? &frame.datum_mm.z
                                       : nullptr;
    if (part == nullptr || word.value.empty())
      throw ProgramFault{word.name + word.value, "is not a shift along X, Y or Z"};
    *part = mm(word) + (incremental ? *part : 0);
  }
}

void KlartextMachine::rotate(const Words& words) {
  KlartextFrame& frame = path_.changing_frame();
  for (const KlartextWord& word : words) {
    if (word.name != "ROT" && word.name != "IROT")
      throw ProgramFault{word.name + word.value, "must be ROT, the angle"};
    const double before = word.name == "IROT" ? frame.rotation_deg : 0;
    frame.rotation_deg = before + values_.of(word.value);
  }
}

}  // namespace kerf
