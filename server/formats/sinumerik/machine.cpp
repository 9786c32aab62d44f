// SPDX-License-Identifier: Apache-2.0
#include "server/formats/sinumerik/machine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/letter_case.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr double kToolMax = 1e9, kCodeMax = 9999;

// Words without effect on the path, which is followed exactly.
constexpr std::string_view kWithoutEffect[] = {
    "SOFT",      "BRISK",      "DRIVE",     "FFWON",     "FFWOF",       "COMPON",    "COMPOF",
    "COMPCURV",  "COMPCAD",    "STOPRE",    "UPATH",     "SPATH",       "DIAMOF",    "ORIWKS",
    "ORIMKS",    "ORIVECT",    "ORIAXES",   "ORIPLANE",  "ORIRESET",    "OSOF",      "OSC",
    "OSS",       "OSD",        "OST",       "CFC",       "CFTCP",       "CFIN",      "CUT2D",
    "CUT2DF",    "CUT3DC",     "KONT",      "NORM",      "KONTC",       "KONTT",     "CDON",
    "CDOF",      "CDOF2",      "FNORM",     "FIFOCTRL",  "STARTFIFO",   "STOPFIFO",  "WALIMON",
    "WALIMOF",   "RTLION",     "RTLIOF",    "SPCON",     "SPCOF",       "DYNNORM",   "DYNPOS",
    "DYNROUGH",  "DYNSEMIFIN", "DYNFINISH", "DYNPREC",   "SETMS",       "ADISPOSOF", "FGROUP",
    "EXTCALLOF", "CYCLE832",   "MSG",       "WORKPIECE", "GROUP_BEGIN", "GROUP_END", "FGREF",
    "CPRECON",   "CPRECOF",    "COMPSURF",  "ORISON",    "ORISOF",      "SPOS",      "ADIS",
    "ADISPOS",   "FL",         "STOLF",     "OTOL",      "CTOL",        "FP",        "OVR",
    "ACC",       "SCC"};

bool has_no_effect(const std::string& name) {
  return std::ranges::find(kWithoutEffect, name) != std::end(kWithoutEffect);
}

int integer(const SinumerikWord& word) {
  if (word.kind != SinumerikWord::Kind::kValue || word.value != std::floor(word.value) ||
      word.value < 0 || word.value > kCodeMax)
    throw ProgramFault{word.name, "requires an integer from 0 to 9999"};
  return static_cast<int>(word.value);
}

// M and the number of its spindle: "M", "M1".
bool is_word_of(const std::string& name, char letter) {
  return !name.empty() && name[0] == letter &&
         (name.size() == 1 || (name.size() == 2 && is_digit(name[1])));
}

}  // namespace

SinumerikMachine::SinumerikMachine(const Scene& scene, SinumerikValues& values, GcodeCanon& canon,
                                   Warn warn, bool changes_by_t, bool offsets_are_wear)
    : scene_(scene),
      values_(values),
      canon_(canon),
      warn_(std::move(warn)),
      changes_by_t_(changes_by_t),
      offsets_are_wear_(offsets_are_wear),
      compensation_([this](const CompensatedMove& move) { emit(move); },
                    CompensationEntry::kAcrossNext) {
  canon_.set_warn(warn_);
}

bool SinumerikMachine::execute(const SinumerikLine& line, std::size_t number) {
  line_ = number;
  if (const auto from = line.comment.find_first_not_of(" ;"); from != std::string::npos)
    canon_.remark({.text = line.comment.substr(from)});
  const std::string& text = line.text;
  if (text.empty() || text[0] == '%' || text[0] == ';') return false;
  if (statement(text) || frame_statement(text) || cycle_statement(text)) return false;
  Words words = sinumerik_words(text, values_);
  in_machine_ = dwells_ = ends_ = false;
  prepare(words);
  if (dwells_) {
    dwell(words);
  } else if (in_machine_) {
    go_to_machine(words);
  } else {
    move(words);
  }
  assign(words);
  for (const SinumerikWord& word : words)
    if (!word.used)
      throw ProgramFault{word.name, word.kind == SinumerikWord::Kind::kCall
                                        ? "calls a cycle or subprogram that is not supported; post "
                                          "its motions"
                                        : "is not a supported word of a block"};
  return ends_;
}

// Statements that are whole blocks.
bool SinumerikMachine::statement(const std::string& text) {
  if (begins_word(text, "DEF")) return define(text.substr(3)), true;
  if (begins_word(text, "PROC") || begins_word(text, "EXTERN")) return true;
  if (begins_word(text, "RET"))
    throw ProgramFault{"RET", "outside of a subprogram is not supported"};
  for (const std::string_view word :
       {"CASE", "REPEAT", "CALL", "EXTCALL", "MCALL", "G290", "G291", "DEFINE", "REPEATB"})
    if (begins_word(text, word) && !(word == "MCALL"))
      throw ProgramFault{std::string(word), "is not supported; post the motions of the program"};
  return false;
}

// REAL A, B=5
void SinumerikMachine::define(std::string text) {
  std::size_t at = skip_blanks(text, 0);
  while (at < text.size() && is_sinumerik_name(text[at])) ++at;
  while (at < text.size()) {
    at = skip_blanks(text, at);
    std::size_t end = at;
    while (end < text.size() && is_sinumerik_name(text[end])) ++end;
    const std::string name = text.substr(at, end - at);
    if (name.empty() || is_digit(name[0]) || (end < text.size() && text[end] == '['))
      throw ProgramFault{"DEF", "must name variables; arrays are not supported"};
    values_.define(name);
    at = skip_blanks(text, end);
    if (at < text.size() && text[at] == '=') values_.set(name, values_.expression(text, ++at));
    at = skip_blanks(text, at);
    if (at < text.size() && text[at++] != ',') throw ProgramFault{"DEF", "lacks ',' between names"};
  }
}

// Modes, tools and M functions. Marks the words that it uses.
void SinumerikMachine::prepare(Words& words) {
  std::vector<int> m_codes;
  bool speed = false;
  for (SinumerikWord& word : words) {
    word.used = true;
    if (word.name == "G" && word.kind == SinumerikWord::Kind::kValue) {
      g_code(word);
    } else if (is_word_of(word.name, 'M')) {
      m_codes.push_back(integer(word));
    } else if (is_word_of(word.name, 'S') && word.kind == SinumerikWord::Kind::kValue) {
      speed = speed || (!dwells_ && rpm_ != word.value);
      if (!dwells_) rpm_ = std::max(0.0, word.value);
      word.used = !dwells_;
    } else if (word.name == "F" && !dwells_) {
      feed_ = word.value;
    } else if (word.name == "T" || word.name == "T1") {
      select_tool(word);
    } else if (word.name == "D" || word.name == "H" || word.name == "DL") {
      continue;  // coordinates are those of the tip
    } else if (word.kind == SinumerikWord::Kind::kKeyword || word.name == "TRAORI") {
      keyword(word);
    } else {
      word.used = has_no_effect(word.name);
    }
  }
  if (selected_ && (changes_by_t_ || std::ranges::find(m_codes, 6) != m_codes.end())) change_tool();
  const bool turns = std::ranges::any_of(m_codes, [](int code) { return code >= 3 && code <= 5; });
  if (speed && turning_ && !turns) remark_spindle();
  for (const int code : m_codes) m_code(code);
}

void SinumerikMachine::keyword(SinumerikWord& word) {
  const std::string& name = word.name;
  if (name == "SUPA") {
    in_machine_ = true;
  } else if (name == "TRAORI" || name == "TRAFOOF") {
    follow_tool(name == "TRAORI");
  } else if (name == "CIP") {
    motion_ = Motion::kThroughPoint;
  } else if (name == "CT" || name == "ASPLINE" || name == "BSPLINE" || name == "CSPLINE") {
    throw ProgramFault{name, "is not supported; post lines and arcs"};
  } else {
    word.used = has_no_effect(name);
  }
}

void SinumerikMachine::g_code(const SinumerikWord& word) {
  const int code = integer(word);
  const std::string name = "G" + std::to_string(code);
  const auto refuse = [&name](const char* reason) { throw ProgramFault{name, reason}; };
  if (code <= 3) motion_ = static_cast<Motion>(code);
  if (code == 4) dwells_ = true;
  if (code == 17 || code == 18 || code == 19) {
    if (plane_ != static_cast<ArcPlane>(code - 17)) refuse_compensated(name);
    plane_ = static_cast<ArcPlane>(code - 17);
  }
  if (code >= 40 && code <= 42) return compensate(code);
  if (code == 53 || code == 153 || code == 74 || code == 75) in_machine_ = true;
  if (code == 70 || code == 700) unit_mm_ = kMmPerInch;
  if (code == 71 || code == 710) unit_mm_ = 1;
  if (code == 700) feed_unit_mm_ = kMmPerInch;
  if (code == 710) feed_unit_mm_ = 1;
  if (code == 90 || code == 91) incremental_ = code == 91;
  if (code >= 93 && code <= 95) {
    feed_mode_ = code == 93   ? FeedMode::kInverse
                 : code == 94 ? FeedMode::kPerMinute
                              : FeedMode::kPerRevolution;
    feed_ = 0;
  }
  const bool system = (code >= 54 && code <= 57) || (code >= 505 && code <= 599);
  if (system && system_ != 0 && system_ != code && warned_.insert("system").second)
    warn_(name + ": several work offsets are used, whose places are not known; all are the origin");
  if (system) system_ = code;
  static constexpr int kTaken[] = {0,   1,   2,   3,   4,   9,   17,  18,  19,  53,  60,  64,  70,
                                   71,  74,  75,  90,  91,  93,  94,  95,  97,  153, 450, 451, 500,
                                   601, 602, 603, 621, 641, 642, 643, 644, 645, 700, 710};
  if (!system && std::ranges::find(kTaken, code) == std::end(kTaken)) refuse("is not supported");
}

void SinumerikMachine::m_code(int code) {
  using Kind = MachineRemark::Kind;
  if (code <= 1) canon_.remark({.kind = code == 0 ? Kind::kStop : Kind::kOptionalStop});
  if (code == 2 || code == 17 || code == 30) ends_ = true;
  if (code == 3 || code == 4) {
    turning_ = code == 3 ? Kind::kSpindleClockwise : Kind::kSpindleCounterClockwise;
    remark_spindle();
  }
  if (code == 5) {
    turning_.reset();
    canon_.remark({.kind = Kind::kSpindleStop});
  }
  if (code == 7) canon_.remark({.kind = Kind::kMist});
  if (code == 8) canon_.remark({.kind = Kind::kFlood});
  if (code == 9) canon_.remark({.kind = Kind::kCoolantOff});
  const bool known = code <= 9 || code == 17 || code == 19 || code == 30 || code == 70 ||
                     (code >= 40 && code <= 45);
  if (!known && warned_.insert("M" + std::to_string(code)).second)
    warn_("M" + std::to_string(code) + " is taken as a function that moves nothing");
}

void SinumerikMachine::remark_spindle() { canon_.remark({.kind = *turning_, .rpm = rpm_}); }

// T5, T=5, T="MILL"
void SinumerikMachine::select_tool(const SinumerikWord& word) {
  if (word.kind == SinumerikWord::Kind::kText) {
    const auto [it, added] =
        named_tools_.try_emplace(word.text, static_cast<ToolId>(named_tools_.size() + 1));
    if (added)
      warn_("T=\"" + word.text + "\" is taken as tool " + std::to_string(it->second) +
            " of the scene");
    selected_ = it->second;
    return;
  }
  if (!(word.value >= 0 && word.value <= kToolMax && word.value == std::floor(word.value)))
    throw ProgramFault{"T", "is not a tool number"};
  selected_ = static_cast<ToolId>(word.value);
}

void SinumerikMachine::change_tool() {
  refuse_compensated("T");
  loaded_ = *selected_ == 0 ? std::nullopt : selected_;
  canon_.change_tool(loaded_);
  if (changes_by_t_ && warned_.insert("T").second)
    warn_("T changes the tool at once, because the program has no M6");
  selected_.reset();
}

// R5=… and variables, computed from the values at the start of the block.
void SinumerikMachine::assign(Words& words) {
  for (SinumerikWord& word : words) {
    if (word.used || word.kind != SinumerikWord::Kind::kValue || !values_.has(word.name)) continue;
    values_.set(word.name, word.value);
    word.used = true;
  }
}

}  // namespace kerf
