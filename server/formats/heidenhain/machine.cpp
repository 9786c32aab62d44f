// SPDX-License-Identifier: Apache-2.0
#include "server/formats/heidenhain/machine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/formats/letter_case.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr double kToolMax = 1e9, kCodeMax = 999;

bool begins(const std::string& text, std::string_view word) {
  return text.starts_with(word) && (text.size() == word.size() || text[word.size()] == ' ');
}

std::string after(const std::string& text, std::string_view word) {
  const auto at = text.find_first_not_of(' ', std::min(word.size(), text.size()));
  return at == std::string::npos ? std::string() : text.substr(at);
}

// Blocks that change nothing on the workpiece.
bool is_idle(const std::string& text) {
  for (const std::string_view word :
       {"BLK FORM", "TOOL DEF", "STOP", "FUNCTION MODE MILL", "CYCL DEF 32", "CYCL DEF 247",
        "CYCL DEF 13.", "CYCL DEF 239", "END PGM"})
    if (text.starts_with(word)) return true;
  return false;
}

void check_words(const std::vector<KlartextWord>& words) {
  static constexpr std::string_view kKnown[] = {"X",   "Y",   "Z",  "IX", "IY", "IZ", "A",
                                                "B",   "C",   "IA", "IB", "IC", "PA", "PR",
                                                "IPA", "IPR", "R",  "DR", ""};
  for (const KlartextWord& word : words)
    if (word.value.empty() || std::ranges::find(kKnown, word.name) == std::end(kKnown))
      throw ProgramFault{word.name + word.value, "is not a word of this path function"};
}

bool is_m128(const KlartextWord& word) { return word.name == "M" && word.value == "128"; }

// "C" after "M94".
bool is_reduced_axis(const KlartextWord& before, const KlartextWord& word) {
  return before.name == "M" && before.value == "94" && word.value.empty() &&
         (word.name == "A" || word.name == "B" || word.name == "C");
}

}  // namespace

KlartextMachine::KlartextMachine(const Scene& scene, MotionSink& sink, KlartextValues& values,
                                 Warn warn, bool offsets_are_wear)
    : scene_(scene),
      values_(values),
      warn_(warn),
      offsets_are_wear_(offsets_are_wear),
      path_(scene, sink, std::move(warn)) {}

bool KlartextMachine::execute(const KlartextBlock& block, const std::string& following) {
  const std::string& text = block.text;
  path_.at_line(block.line);
  if (text.starts_with("END PGM")) return true;
  if (begins(text, "STOP")) path_.remark({.kind = MachineRemark::Kind::kStop});
  if (is_idle(text) || text.empty()) return false;
  if (text.starts_with("BEGIN PGM")) return begin(text), false;
  if (text[0] != 'L' && text[0] != 'C' && text[0] != 'R') refuse_in_corner(text);
  if (text.starts_with("TOOL CALL")) return call_tool(after(text, "TOOL CALL")), false;
  if (text.starts_with("CYCL")) refuse_in_corner(text);
  if (text.starts_with("CYCL DEF")) return cycle_definition(after(text, "CYCL DEF")), false;
  if (begins(text, "APPR")) return approach(after(text, "APPR")), false;
  if (begins(text, "DEP")) return depart(after(text, "DEP")), false;
  if (begins(text, "PLANE")) return tilt(after(text, "PLANE")), false;
  if (text.starts_with("FUNCTION TCPM")) return tool_center(text), false;
  if (text.starts_with("FUNCTION RESET TCPM")) return path_.set_tool_center(false), false;
  if (begins(text, "CYCL CALL")) {
    std::string rest = after(text, "CYCL CALL");
    const bool at_place = begins(rest, "POS");
    if (at_place) rest = after(rest, "POS");
    Words words = klartext_words(rest);
    const Extras extras = read_extras(words);
    if (!words.empty() && !at_place)
      throw ProgramFault{"CYCL CALL", "is supported without PAT; use L … M99"};
    if (at_place) {
      call_at(words);
    } else {
      call_cycle();
    }
    cycle_modal_ = false;
    return extras.ends;
  }
  const std::string_view path_words[] = {"LN", "LP",  "LT", "L", "CC",  "CP",
                                         "CR", "CTP", "CT", "C", "RND", "CHF"};
  for (const std::string_view word : path_words)
    if (begins(text, word))
      return path_function(word, klartext_words(after(text, word)), following);
  if (text[0] == 'M' && text.size() > 1 && is_digit(text[1])) {
    Words words = klartext_words(text);
    const Extras extras = read_extras(words);
    if (!words.empty())
      throw ProgramFault{words[0].name + words[0].value, "is not a word beside M"};
    if (extras.calls_cycle) call_cycle();
    return extras.ends;
  }
  const std::string word = text.substr(0, text.find(' '));
  throw ProgramFault{word, "is not a supported statement"};
}

bool KlartextMachine::path_function(std::string_view word, Words words,
                                    const std::string& following) {
  const bool corners = word == "RND" || word == "CHF";
  const std::optional<double> feed_before = feed_;
  const Extras extras = read_extras(words);
  if (extras.in_machine && word != "L")
    throw ProgramFault{std::string(word), "in machine coordinates (M91, M92) is not supported"};
  if (word != "LN") check_words(words);
  const bool corner_follows = following.starts_with("RND") || following.starts_with("CHF");
  if (word == "CC") {
    pole(words);
  } else if (word == "L") {
    linear(words, extras, corner_follows);
  } else if (word == "LN") {
    linear_with_vectors(std::move(words), extras);
  } else if (word == "LP") {
    polar_line(words, extras, corner_follows);
  } else if (word == "C") {
    circle(words);
  } else if (word == "CP") {
    polar_circle(words);
  } else if (word == "CR") {
    circle_by_radius(words);
  } else if (word == "CT") {
    tangent_circle(words);
  } else if (corners) {
    if (extras.rapid) throw ProgramFault{"FMAX", "beside RND and CHF is not supported"};
    corner(words, word == "CHF");
    // F of RND and CHF applies to the corner only.
    if (feed_ != feed_before) corner_->own_feed = feed();
    feed_ = feed_before;
  } else {
    throw ProgramFault{std::string(word), "is not supported; post with L, CC, C, CP, CR and CT"};
  }
  if (extras.calls_cycle || (cycle_modal_ && word != "CC" && !corners)) {
    if (extras.in_machine)
      throw ProgramFault{"M99", "beside M91 and M92 is not supported: the place is not known"};
    call_cycle();
  }
  return extras.ends;
}

// RL and RR take the radius of the scene's tool.
void KlartextMachine::compensate(const std::string& word) {
  const int side = word == "RL" ? 1 : word == "RR" ? -1 : 0;
  if ((side != 0) == path_.is_compensated() && side == 0) return;
  refuse_in_corner(word);
  path_.compensate(side, offsets_are_wear_ ? oversize_mm_ : tool_radius_mm(word));
}

double KlartextMachine::tool_radius_mm(const std::string& word) const {
  std::optional<ToolId> tool = path_.tool();
  if (!tool && scene_.tools.size() == 1) tool = scene_.tools.begin()->first;
  const auto found = tool ? scene_.tools.find(*tool) : scene_.tools.end();
  if (found == scene_.tools.end()) throw ProgramFault{word, "requires a tool"};
  const double radius_mm = found->second.tool.radius_mm + oversize_mm_;
  if (radius_mm < 0)
    throw ProgramFault{word, "DR of TOOL CALL makes the tool's radius less than 0"};
  return radius_mm;
}

void KlartextMachine::finish() {
  path_.finish();
  if (corner_) throw ProgramFault{"RND", "must be followed by a straight line"};
}

void KlartextMachine::refuse_in_corner(const std::string& word) const {
  if (corner_) throw ProgramFault{word, "between the lines of RND or CHF is not supported"};
}

void KlartextMachine::refuse_off_axis(const std::string& word) const {
  if (!path_.is_axis_z())
    throw ProgramFault{word,
                       "along a tool axis that M128 turned away from Z is not supported; use "
                       "PLANE SPATIAL"};
}

void KlartextMachine::begin(const std::string& text) {
  unit_mm_ = text.ends_with(" INCH") ? kMmPerInch : 1;
}

// TOOL CALL 5 Z S3000 F500 DL+0 DR+0, TOOL CALL "NAME" Z, TOOL CALL Z S500 (speed only).
void KlartextMachine::call_tool(std::string text) {
  std::optional<ToolId> tool;
  bool changes = true;
  if (text.starts_with('"')) {
    const std::size_t end = text.find('"', 1);
    const std::string name = text.substr(1, end == std::string::npos ? end : end - 1);
    const auto [it, added] =
        named_tools_.try_emplace(name, static_cast<ToolId>(named_tools_.size() + 1));
    if (added)
      warn_("TOOL CALL \"" + name + "\" is taken as tool " + std::to_string(it->second) +
            " of the scene");
    tool = it->second;
    text = end == std::string::npos ? "" : text.substr(end + 1);
  }
  Words words = klartext_words(text);
  if (!tool && !words.empty() && words[0].name.empty()) {
    const double number = values_.of(words[0].value);
    if (number < 0 || number > kToolMax || number != std::floor(number))
      throw ProgramFault{words[0].value, "is not a tool number"};
    if (number > 0) tool = static_cast<ToolId>(number);
    words.erase(words.begin());
  } else if (!tool) {
    changes = false;
  }
  if (changes) oversize_mm_ = 0;
  for (std::size_t i = 0; i < words.size(); ++i) tool_word(words, i);
  if (changes) {
    path_.change_tool(tool);
  } else if (turning_) {
    turn_spindle(*turning_);  // at the new speed
  }
  direction_.reset();
}

// Reads Z, S, F, the oversize DR, and other words if they are 0. Advances `at` to the value of
// "DR2:+0".
void KlartextMachine::tool_word(const Words& words, std::size_t& at) {
  KlartextWord word = words[at];
  if (word.value.empty() && (word.name == "X" || word.name == "Y"))
    throw ProgramFault{word.name, "as tool axis is not supported; Z is"};
  if (word.value.empty() && word.name == "Z") return;
  if (word.name == "S" && !word.value.empty()) {
    rpm_ = std::max(0.0, values_.of(word.value));
    return;
  }
  if (word.name == "F" && !word.value.empty()) {
    feed_ = values_.of(word.value) * unit_mm_;
    return;
  }
  if (word.name == "DR" && word.value == "2") {
    if (at + 1 < words.size() && words[at + 1].name == ":") ++at;
    word = {.name = "DR2", .value = {}};
    if (at + 1 < words.size() && words[at + 1].name.empty()) word.value = words[++at].value;
  }
  const bool oversize = word.name == "DL" || word.name == "DR" || word.name == "DR2";
  if (!oversize || word.value.empty())
    throw ProgramFault{word.name + word.value, "is not a supported word of TOOL CALL"};
  if (word.name == "DR") {
    oversize_mm_ = values_.of(word.value) * unit_mm_;
    return;
  }
  if (values_.of(word.value) != 0)
    throw ProgramFault{word.name + word.value,
                       "is an oversize, which is not supported; state the tool as it is"};
}

// FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS, which is M128.
void KlartextMachine::tool_center(const std::string& text) {
  struct Refused {
    std::string_view words, reason;
  };
  static constexpr Refused kRefused[] = {
      {"AXIS SPAT", "takes A, B and C as spatial angles, which is not supported; use AXIS POS"},
      {"PATHCTRL VECTOR", "is not supported; use PATHCTRL AXIS"},
      {"CENTER", "as the point that is guided is not supported; use REFPNT TIP-TIP"}};
  for (const Refused& refused : kRefused)
    if (text.find(refused.words) != std::string::npos)
      throw ProgramFault{std::string(refused.words), std::string(refused.reason)};
  path_.set_tool_center(true);
}

// Removes M words, feeds and the radius correction from a block.
KlartextMachine::Extras KlartextMachine::read_extras(Words& words) {
  Extras extras;
  Words rest;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const KlartextWord& word = words[i];
    const bool apart = word.name == "F" && word.value.empty() && i + 1 < words.size();
    if (word.name == "FMAX" || (apart && words[i + 1].name == "MAX")) {
      extras.rapid = true;
    } else if (word.name == "F" && i > 0 && is_m128(words[i - 1])) {
      continue;  // the greatest feed of the compensating axes
    } else if (word.name == "F" && !word.value.empty()) {
      feed_ = values_.of(word.value) * unit_mm_;
    } else if (word.name == "FAUTO" || (apart && words[i + 1].name == "AUTO")) {
      if (apart) ++i;
    } else if (word.name == "RL" || word.name == "RR") {
      compensate(word.name);
    } else if (word.name == "R" && word.value == "0") {
      compensate("R0");
    } else if (word.name == "M" && !word.value.empty()) {
      const double code = values_.of(word.value);
      if (!(code >= 0 && code <= kCodeMax && code == std::floor(code)))
        throw ProgramFault{word.name + word.value, "is not an M function"};
      m_code(static_cast<int>(code), words, i, extras);
    } else if (i > 0 && is_reduced_axis(words[i - 1], word)) {
      continue;
    } else if (word.name == "MB" || word.name == "MBMAX" || word.name == "MAX" ||
               (word.name == "S" && !word.value.empty())) {
      continue;
    } else {
      rest.push_back(word);
    }
  }
  words = std::move(rest);
  if (extras.retract_mm) {
    refuse_in_corner("M140");
    if (std::isinf(*extras.retract_mm)) {
      path_.retract();
    } else {
      refuse_off_axis("M140");
      Vec3 to = path_.position();
      to.z += *extras.retract_mm;
      move(to, std::nullopt, {false, false, true});
    }
  }
  return extras;
}

void KlartextMachine::m_code(int code, const Words& words, std::size_t at, Extras& extras) {
  remark(code);
  switch (code) {
    case 2:
    case 30:
      extras.ends = true;
      return;
    case 89:
      cycle_modal_ = extras.calls_cycle = true;
      return;
    case 91:
    case 92:
      extras.in_machine = true;
      extras.datum_of_builder = code == 92;
      return;
    case 99:
      extras.calls_cycle = true;
      cycle_modal_ = false;
      return;
    case 94: {
      const bool one = at + 1 < words.size() && is_reduced_axis(words[at], words[at + 1]);
      return path_.reduce_angles(one ? words[at + 1].name : "ABC");
    }
    case 126:
    case 127:
      shortest_ = code == 126;
      return;
    case 128:
    case 129:
      refuse_in_corner("M" + std::to_string(code));
      return path_.set_tool_center(code == 128);
    case 140: {
      const KlartextWord* next = at + 1 < words.size() ? &words[at + 1] : nullptr;
      const bool most = next != nullptr && next->name == "MB" && next->value.empty();
      if (next == nullptr || !next->name.starts_with("MB"))
        throw ProgramFault{"M140", "requires MB, the distance"};
      extras.retract_mm =
          most || next->name == "MBMAX" ? std::numeric_limits<double>::infinity() : mm(*next);
      return;
    }
    case 97:
    case 130:
    case 136:
    case 144:
      throw ProgramFault{"M" + std::to_string(code), "is not supported"};
    default:
      if (code > 9 && code != 13 && code != 14 && code != 120)
        warn_("M" + std::to_string(code) + " is taken as a function that moves nothing");
  }
}

}  // namespace kerf
