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

constexpr double kToolMax = 1e9;

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
      throw KlartextFault{word.name + word.value, "is not a word of this path function"};
}

}  // namespace

KlartextMachine::KlartextMachine(const Scene& scene, MotionSink& sink, KlartextValues& values,
                                 Warn warn)
    : scene_(scene), values_(values), warn_(warn), path_(scene, sink, std::move(warn)) {}

bool KlartextMachine::execute(const KlartextBlock& block, const std::string& following) {
  const std::string& text = block.text;
  path_.at_line(block.line);
  if (text.starts_with("END PGM")) return true;
  if (is_idle(text) || text.empty()) return false;
  if (text.starts_with("BEGIN PGM")) return begin(text), false;
  if (text.starts_with("TOOL CALL")) return call_tool(after(text, "TOOL CALL")), false;
  if (text.starts_with("CYCL DEF")) return cycle_definition(after(text, "CYCL DEF")), false;
  if (begins(text, "PLANE")) return tilt(after(text, "PLANE")), false;
  if (text.starts_with("FUNCTION TCPM")) return path_.set_tool_center(true), false;
  if (text.starts_with("FUNCTION RESET TCPM")) return path_.set_tool_center(false), false;
  if (begins(text, "CYCL CALL")) {
    Words words = klartext_words(after(text, "CYCL CALL"));
    const Extras extras = read_extras(words);
    if (!words.empty())
      throw KlartextFault{"CYCL CALL", "is supported without PAT and POS; use L … M99"};
    drill();
    return extras.ends;
  }
  const std::string_view path_words[] = {"LN", "LP",  "LT", "L", "CC",  "CP",
                                         "CR", "CTP", "CT", "C", "RND", "CHF"};
  for (const std::string_view word : path_words) {
    if (!begins(text, word)) continue;
    Words words = klartext_words(after(text, word));
    const Extras extras = read_extras(words);
    check_words(words);
    if (word == "CC") {
      pole(words);
    } else if (word == "L") {
      const bool corner_follows = begins(following, "RND") || begins(following, "CHF") ||
                                  following.starts_with("RND") || following.starts_with("CHF");
      linear(words, extras, corner_follows);
    } else if (word == "LP") {
      polar_line(words, extras);
    } else if (word == "C") {
      circle(words);
    } else if (word == "CP") {
      polar_circle(words);
    } else if (word == "CR") {
      circle_by_radius(words);
    } else if (word == "CT") {
      tangent_circle(words);
    } else if (word == "RND" || word == "CHF") {
      corner(words, word == "CHF");
    } else {
      throw KlartextFault{std::string(word), "is not supported; post with L, CC, C, CP, CR and CT"};
    }
    if (extras.calls_cycle || (cycle_modal_ && word == "L" && cycle_number_ != 0)) drill();
    return extras.ends;
  }
  if (text[0] == 'M' && text.size() > 1 && is_digit(text[1])) {
    Words words = klartext_words(text);
    return read_extras(words).ends;
  }
  const std::string word = text.substr(0, text.find(' '));
  throw KlartextFault{word, word == "APPR" || word == "DEP"
                                ? "approaches a contour with radius compensation, which is not "
                                  "supported; post the path of the tool's center (R0)"
                                : "is not a supported statement"};
}

void KlartextMachine::finish() const {
  if (corner_) throw KlartextFault{"RND", "must be followed by a straight line"};
}

void KlartextMachine::begin(const std::string& text) {
  unit_mm_ = text.ends_with(" INCH") ? kMmPerInch : 1;
}

// TOOL CALL 5 Z S3000 F500 DL+0 DR+0, TOOL CALL "NAME" Z, TOOL CALL Z S500 (the speed only).
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
      throw KlartextFault{words[0].value, "is not a tool number"};
    if (number > 0) tool = static_cast<ToolId>(number);
    words.erase(words.begin());
  } else if (!tool) {
    changes = false;
  }
  for (const KlartextWord& word : words) {
    if (word.name == "F" && !word.value.empty()) feed_ = values_.of(word.value) * unit_mm_;
    const bool axis = word.value.empty() && (word.name == "X" || word.name == "Y");
    if (axis) throw KlartextFault{word.name, "as tool axis is not supported; Z is"};
  }
  if (changes) path_.change_tool(tool);
  direction_.reset();
}

void KlartextMachine::cycle_definition(const std::string& text) {
  std::size_t end = 0;
  while (end < text.size() && (is_digit(text[end]) || text[end] == '.')) ++end;
  const std::string number = text.substr(0, end);
  const std::string rest = text.substr(end);
  const int cycle = number.empty() ? 0 : std::atoi(number.c_str());
  const bool title = number.ends_with(".0");
  if (cycle == 7 || cycle == 10 || cycle == 9) {
    if (title) return;
    if (cycle == 7) return datum_shift(klartext_words(rest));
    if (cycle == 10) return rotate(klartext_words(rest));
    for (const KlartextWord& word : klartext_words(rest))
      if (!word.value.empty()) path_.dwell(std::max(0.0, values_.of(word.value)));
    return;
  }
  const bool holes = cycle == 200 || cycle == 201 || cycle == 202 || cycle == 203 || cycle == 205 ||
                     cycle == 206 || cycle == 207 || cycle == 209 || cycle == 240 || cycle == 241;
  if (!holes)
    throw KlartextFault{"CYCL DEF " + number,
                        "is not supported; 7, 9, 10, 32, 200 to 203, 205 to 207, 209, 240, 241 and "
                        "247 are: post the motions of others as L and C"};
  cycle_.clear();
  for (std::size_t at = rest.find('Q'); at != std::string::npos; at = rest.find('Q', at + 1)) {
    std::size_t stop = at + 1;
    while (stop < rest.size() && is_digit(rest[stop])) ++stop;
    const std::string name = rest.substr(at, stop - at);
    while (stop < rest.size() && rest[stop] == ' ') ++stop;
    if (name.size() < 2 || stop >= rest.size() || rest[stop] != '=') continue;
    const std::size_t from = rest.find_first_not_of(' ', stop + 1);
    if (from == std::string::npos) continue;
    const std::string value = rest.substr(from, rest.find(' ', from) - from);
    if (value.find_first_of("0123456789Q") == std::string::npos) continue;  // FMAX, AUTO
    std::string plain = value;
    std::ranges::replace(plain, ',', '.');
    cycle_[name] = values_.of(plain);
    values_.set(name, cycle_[name]);
    at = from;
  }
  for (const char* needed : {"Q200", "Q201", "Q203"})
    if (!cycle_.contains(needed))
      throw KlartextFault{"CYCL DEF " + number, std::string("requires ") + needed};
  if (cycle == 240 && cycle_.contains("Q343") && cycle_["Q343"] != 0)
    throw KlartextFault{"Q343", "selects a depth by the diameter, which is not supported"};
  cycle_number_ = cycle;
}

// The hole at the current place: down to Q203 + Q201 and up to the second clearance Q204.
void KlartextMachine::drill() {
  if (cycle_number_ == 0) throw KlartextFault{"M99", "calls a cycle that is not defined"};
  const auto value = [this](const char* name, double missing) {
    const auto it = cycle_.find(name);
    return it == cycle_.end() ? missing : it->second;
  };
  const double surface = value("Q203", 0) * unit_mm_;
  const double clearance = surface + value("Q200", 0) * unit_mm_;
  const double high = std::max(clearance, surface + value("Q204", 0) * unit_mm_);
  const double bottom = surface + value("Q201", 0) * unit_mm_;
  const double plunge = value("Q206", feed_.value_or(0) / unit_mm_) * unit_mm_;
  const bool taps = cycle_number_ == 206 || cycle_number_ == 207 || cycle_number_ == 209;
  const double feed = plunge > 0 ? plunge : taps ? feed_.value_or(1000) : 0;
  if (!(feed > 0)) throw KlartextFault{"Q206", "requires a feed above 0"};
  if (bottom > clearance) throw KlartextFault{"Q201", "is a depth above the clearance"};
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

void KlartextMachine::datum_shift(const Words& words) {
  KlartextFrame& frame = path_.frame();
  if (frame.is_tilted)
    throw KlartextFault{"CYCL DEF 7", "in a tilted plane is not supported; shift before PLANE"};
  for (const KlartextWord& word : words) {
    const bool incremental = word.name.size() == 2 && word.name[0] == 'I';
    const char axis = word.name.empty() ? ' ' : word.name.back();
    if (axis == '#') throw KlartextFault{"#", "names a datum table, which is not known here"};
    double* const part = axis == 'X'   ? &frame.datum_mm.x
                         : axis == 'Y' ? &frame.datum_mm.y
                         : axis == 'Z' ? &frame.datum_mm.z
                                       : nullptr;
    if (part == nullptr || word.value.empty())
      throw KlartextFault{word.name + word.value, "is not a shift along X, Y or Z"};
    *part = mm(word) + (incremental ? *part : 0);
  }
}

void KlartextMachine::rotate(const Words& words) {
  KlartextFrame& frame = path_.frame();
  for (const KlartextWord& word : words) {
    if (word.name != "ROT" && word.name != "IROT")
      throw KlartextFault{word.name + word.value, "must be ROT, the angle"};
    const double before = word.name == "IROT" ? frame.rotation_deg : 0;
    frame.rotation_deg = before + values_.of(word.value);
  }
}

// PLANE RESET and PLANE SPATIAL SPA SPB SPC, whose angles turn about the fixed X, Y and Z in turn.
void KlartextMachine::tilt(const std::string& text) {
  KlartextFrame& frame = path_.frame();
  if (begins(text, "RESET")) {
    const bool was = std::exchange(frame.is_tilted, false);
    if (was) path_.align();
    return;
  }
  if (!begins(text, "SPATIAL"))
    throw KlartextFault{"PLANE " + text.substr(0, text.find(' ')),
                        "is not supported; use PLANE SPATIAL"};
  if (scene_.machine.kinematics == MachineKinematics::kXyz)
    throw KlartextFault{"PLANE SPATIAL", "tilts the plane, which the machine xyz cannot"};
  if (frame.rotation_deg != 0)
    throw KlartextFault{"PLANE SPATIAL", "with an active rotation (cycle 10) is not supported"};
  double angle[3] = {0, 0, 0};
  bool positions = false;
  for (const KlartextWord& word : klartext_words(after(text, "SPATIAL"))) {
    for (int i = 0; i < 3; ++i)
      if (word.name == std::string("SP") + "ABC"[i]) angle[i] = kRadPerDeg * values_.of(word.value);
    positions = positions || word.name == "TURN" || word.name == "MOVE";
  }
  if (!positions)
    throw KlartextFault{"STAY", "leaves the tool as it was, which is not supported; use TURN"};
  for (int column = 0; column < 3; ++column) {
    Vec3 v{column == 0 ? 1.0 : 0, column == 1 ? 1.0 : 0, column == 2 ? 1.0 : 0};
    const double ca = std::cos(angle[0]), sa = std::sin(angle[0]);
    v = {v.x, ca * v.y - sa * v.z, sa * v.y + ca * v.z};
    const double cb = std::cos(angle[1]), sb = std::sin(angle[1]);
    v = {cb * v.x + sb * v.z, v.y, -sb * v.x + cb * v.z};
    const double cc = std::cos(angle[2]), sc = std::sin(angle[2]);
    frame.tilted[static_cast<std::size_t>(column)] = {cc * v.x - sc * v.y, sc * v.x + cc * v.y,
                                                      v.z};
  }
  frame.is_tilted = true;
  path_.align();
  direction_.reset();
}

// Takes M words, feeds and the radius correction out of a block.
KlartextMachine::Extras KlartextMachine::read_extras(Words& words) {
  Extras extras;
  Words rest;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const KlartextWord& word = words[i];
    if (word.name == "FMAX" || (word.name == "F" && word.value == "MAX")) {
      extras.rapid = true;
    } else if (word.name == "F" && !word.value.empty()) {
      feed_ = values_.of(word.value) * unit_mm_;
    } else if (word.name == "FAUTO") {
      continue;
    } else if (word.name == "RL" || word.name == "RR") {
      throw KlartextFault{word.name,
                          "radius compensation is not supported; post the path of the "
                          "tool's center (R0)"};
    } else if (word.name == "R" && word.value == "0") {
      continue;
    } else if (word.name == "M" && !word.value.empty()) {
      m_code(static_cast<int>(values_.of(word.value)), words, i, extras);
    } else if (word.name == "MB" || word.name == "MBMAX" || word.name == "MAX" ||
               (word.name == "S" && !word.value.empty())) {
      continue;
    } else {
      rest.push_back(word);
    }
  }
  words = std::move(rest);
  if (extras.retract_mm) {
    if (std::isinf(*extras.retract_mm)) {
      path_.retract();
    } else {
      Vec3 to = path_.position();
      to.z += *extras.retract_mm;
      move(to, std::nullopt, {false, false, true});
    }
  }
  return extras;
}

void KlartextMachine::m_code(int code, const Words& words, std::size_t at, Extras& extras) {
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
      return;
    case 99:
      extras.calls_cycle = true;
      cycle_modal_ = false;
      return;
    case 128:
      return path_.set_tool_center(true);
    case 129:
      return path_.set_tool_center(false);
    case 140: {
      const KlartextWord* next = at + 1 < words.size() ? &words[at + 1] : nullptr;
      const bool most = next != nullptr && next->name == "MB" && next->value.empty();
      if (next == nullptr || !next->name.starts_with("MB"))
        throw KlartextFault{"M140", "requires MB, the distance"};
      extras.retract_mm =
          most || next->name == "MBMAX" ? std::numeric_limits<double>::infinity() : mm(*next);
      return;
    }
    case 97:
    case 130:
    case 136:
    case 144:
      throw KlartextFault{"M" + std::to_string(code), "is not supported"};
    default:
      if (code > 9 && code != 13 && code != 14 && code != 126 && code != 127 && code != 120)
        warn_("M" + std::to_string(code) + " is taken as a function that moves nothing");
  }
}

}  // namespace kerf
