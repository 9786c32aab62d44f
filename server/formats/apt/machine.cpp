// SPDX-License-Identifier: Apache-2.0
#include "server/formats/apt/machine.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/formats/number_text.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

// Greatest difference without a warning between the diameters of CUTTER and of the scene's tool.
constexpr double kCutterDifferenceMm = 1e-3;

/// Statements that describe or display and move nothing.
constexpr std::array<std::string_view, 32> kWithoutEffect{"END",
                                                          "PAINT",
                                                          "ENDOFPATH",
                                                          "END-OF-PATH",
                                                          "SELECT",
                                                          "SELECTL",
                                                          "MACHIN",
                                                          "INTOL",
                                                          "OUTTOL",
                                                          "TOLER",
                                                          "LINTOL",
                                                          "ARCSLP",
                                                          "SEQNO",
                                                          "MODE",
                                                          "SET",
                                                          "CLEARP",
                                                          "CHECK",
                                                          "AUXFUN",
                                                          "SWITCH",
                                                          "REWIND",
                                                          "CSI_SET_FLUTE_LENGTH",
                                                          "CSI_SET_EXTENSION_LENGTH",
                                                          "OPSKIP",
                                                          "DISPLAY",
                                                          "VERIFY",
                                                          "NOPOST",
                                                          "CLPRNT",
                                                          "PLABEL",
                                                          "PREFUN",
                                                          "CUTTERHEIGHT",
                                                          "AIR",
                                                          "CLAMP"};

/// Unsupported statements that move or place the tool or the workpiece.
constexpr std::array<std::string_view, 29> kRefused{
    "GOFWD",  "GOBACK", "GOLFT",  "GORGT",  "GOUP",   "GODOWN", "GO",     "GOCLER",
    "TLLFT",  "TLRGT",  "TLON",   "MOVARC", "SPLINE", "NURBS",  "THREAD", "POCKET",
    "PATERN", "MCHPOS", "ROTABL", "ROTATE", "ROTHED", "TRANS",  "ORIGIN", "COPY",
    "TRACUT", "MACRO",  "CALL",   "JUMPTO", "TURRET"};

// The diameter as CUTTER defines it: at the intersection of bottom and side line.
double diameter_mm(const SceneTool& tool) {
  if (const auto* apt = std::get_if<AptShape>(&tool.shape)) return apt->d_mm;
  return 2 * tool.tool.radius_mm;
}

}  // namespace

const AptMachine::Named AptMachine::kStatements[] = {
    {"UNITS", &AptMachine::units},          {"UNIT", &AptMachine::units},
    {"MULTAX", &AptMachine::multax},        {"TOOLPATH", &AptMachine::tool_path},
    {"LOADTL", &AptMachine::load_tool},     {"LOAD", &AptMachine::load_tool},
    {"TOOLNO", &AptMachine::load_tool},     {"UNLOAD", &AptMachine::unload},
    {"CUTTER", &AptMachine::cutter},        {"TLDATA", &AptMachine::cutter},
    {"FEDRAT", &AptMachine::feed_rate},     {"RAPID", &AptMachine::rapid},
    {"SPINDL", &AptMachine::spindle},       {"COOLNT", &AptMachine::coolant},
    {"DELAY", &AptMachine::delay},          {"CSYS", &AptMachine::system},
    {"TRNTYP", &AptMachine::translation},   {"MSYS", &AptMachine::system},
    {"CUTCOM", &AptMachine::cutter_offset}, {"FROM", &AptMachine::from},
    {"GOTO", &AptMachine::go_to},           {"GODLTA", &AptMachine::go_delta},
    {"GOHOME", &AptMachine::go_home},       {"RETRCT", &AptMachine::go_home},
    {"TLAXIS", &AptMachine::tool_axis},     {"CIRCLE", &AptMachine::circle},
    {"INDIRV", &AptMachine::direction},     {"TLON,GOFWD", &AptMachine::circle_to_line},
    {"CYCLE", &AptMachine::cycle},          {"STOP", &AptMachine::stop},
    {"OPSTOP", &AptMachine::stop},          {"FINI", &AptMachine::fini},
};

bool AptMachine::execute(const AptStatement& statement, std::size_t line) {
  line_ = line;
  const std::string& major = statement.major;
  if (statement.is_text) {
    knows_any_ = true;
    free_text(statement);
    return false;
  }
  if (major != "GOTO" && major != "CIRCLE" && major != "FEDRAT") last_circle_.reset();
  for (const Named& named : kStatements)
    if (named.major == major) {
      knows_any_ = true;
      (this->*named.handler)(statement);
      return finished_;
    }
  if (std::ranges::find(kWithoutEffect, major) != kWithoutEffect.end()) return false;
  if (std::ranges::find(kRefused, major) != kRefused.end() || major.starts_with("TLON"))
    refuse(statement);
  if (major.find('=') != std::string::npos)
    throw ProgramFault{major,
                       "defines geometry of a part program; CL data (GOTO/x,y,z) are required"};
  warn_once(major + " is not a known statement and is left out");
  return false;
}

void AptMachine::refuse(const AptStatement& s) {
  throw ProgramFault{
      s.major,
      "is not supported, and moves the tool or the workpiece; post the motions with GOTO, "
      "CIRCLE and CYCLE"};
}

void AptMachine::warn_once(const std::string& text) {
  if (warned_.insert(text).second) warn_(text);
}

void AptMachine::free_text(const AptStatement& s) {
  if (s.major == "PPRINT" || s.major == "INSERT") sink_.remark({.text = s.text});
}

void AptMachine::stop(const AptStatement& s) {
  sink_.remark({.kind = s.major == "STOP" ? MachineRemark::Kind::kStop
                                          : MachineRemark::Kind::kOptionalStop});
}

void AptMachine::units(const AptStatement& s) {
  const std::string unit = s.minor.empty() ? std::string() : s.minor.front();
  if (unit == "MM") {
    unit_mm_ = 1;
  } else if (unit == "INCHES" || unit == "INCH" || unit == "IN") {
    unit_mm_ = kMmPerInch;
  } else {
    throw ProgramFault{unit, "is not a unit; use MM or INCHES"};
  }
}

// The axis of a GOTO also counts without MULTAX, as written by NX.
void AptMachine::multax(const AptStatement& s) {
  if (!s.minor.empty() && s.minor[0] != "ON" && s.minor[0] != "OFF")
    throw ProgramFault{s.minor[0], "must be ON or OFF"};
}

// TOOL PATH/NAME,TOOL,TOOLNAME of NX: loads the tool of the name's rank, unless other statements
// load tools.
void AptMachine::tool_path(const AptStatement& s) {
  has_paths_ = true;
  if (tools_.loads) return;
  for (std::size_t i = 0; i + 1 < s.minor.size(); ++i) {
    if (s.minor[i] != "TOOL") continue;
    const auto rank = tools_.ranks.find(s.minor[i + 1]);
    if (rank == tools_.ranks.end()) return;
    warn_once("tool " + s.minor[i + 1] + " is the tool " + std::to_string(rank->second) +
              " of the scene: the program loads none by number");
    change_tool(std::to_string(rank->second));
  }
}

// LOADTL/n, LOAD/TOOL,n, TOOLNO/n. Adjustments and lengths after the number do not matter.
void AptMachine::load_tool(const AptStatement& s) {
  const std::size_t at = s.major == "LOAD" ? 1 : 0;
  if (s.major == "LOAD" && (s.minor.empty() || s.minor[0] != "TOOL"))
    throw ProgramFault{s.major, "must be LOAD/TOOL,n"};
  if (s.minor.size() <= at) throw ProgramFault{s.major, "requires the number of a tool"};
  change_tool(s.minor[at]);
}

void AptMachine::change_tool(const std::string& number) {
  const double id = apt_number_of(number);
  if (id < 1 || id > 4294967295.0 || id != std::floor(id) ||
      !scene_.tools.contains(static_cast<ToolId>(id)))
    throw ProgramFault{number, "is not the id of a tool of the scene"};
  const auto tool = static_cast<ToolId>(id);
  if (sink_.tool() == tool) return;
  sink_.change_tool(tool, line_);
}

void AptMachine::unload(const AptStatement& s) {
  if (s.minor.empty() || s.minor[0] != "TOOL") return;
  sink_.change_tool(std::nullopt, line_);
  sink_.lift();
}

void AptMachine::cutter(const AptStatement& s) {
  if (s.minor.empty()) throw ProgramFault{s.major, "requires the numbers of a cutter"};
  const auto cutter = apt_cutter(s, unit_mm_);
  if (!cutter) return;
  if (!(cutter->diameter_mm > 0))
    throw ProgramFault{s.major, "the diameter of a cutter must be above 0"};
  cutter_mm_ = cutter->diameter_mm;
}

// Compares the last CUTTER with the moving tool.
void AptMachine::check_cutter() {
  if (!cutter_mm_ || !sink_.tool()) return;
  const double stated = *cutter_mm_;
  cutter_mm_.reset();
  const double loaded = diameter_mm(scene_.tools.at(*sink_.tool()));
  if (std::abs(stated - loaded) > kCutterDifferenceMm)
    warn_once("CUTTER has a diameter of " + decimal_text(stated, 6) + " mm, but tool " +
              std::to_string(*sink_.tool()) + " of the scene, which is used, has " +
              decimal_text(loaded, 6) + " mm");
}

// Reads the unit of a feed. Returns false for any other word.
bool AptMachine::take_feed_unit(const std::string& word, Feed& feed, double& unit) const {
  if (word == "MMPM" || word == "MMPR") {
    unit = 1;
  } else if (word == "IPM" || word == "IPR") {
    unit = kMmPerInch;
  } else if (word != "PERMIN" && word != "PERREV") {
    return false;
  }
  feed.unit = word.ends_with("PR") || word == "IPR" || word == "PERREV" ? FeedUnit::kPerRevolution
                                                                        : FeedUnit::kPerMinute;
  return true;
}

void AptMachine::feed_rate(const AptStatement& s) {
  std::optional<double> value;
  double unit = unit_mm_;
  Feed feed;
  for (const std::string& word : s.minor) {
    if (take_feed_unit(word, feed, unit)) continue;
    if (const auto number = apt_number(word)) {
      if (value) throw ProgramFault{word, "is a second feed; FEDRAT takes one number"};
      value = number;
    } else {
      warn_once("FEDRAT/" + word + " is not known and is left out");
    }
  }
  if (!value || *value <= 0) throw ProgramFault{"FEDRAT", "must give a feed above 0"};
  feed.written = *value;
  feed.mm = *value * unit;
  feed_ = feed;
  rapid_ = false;
}

void AptMachine::rapid(const AptStatement& s) {
  for (const std::string& word : s.minor) warn_once("RAPID/" + word + " is left out");
  rapid_ = true;
}

void AptMachine::spindle(const AptStatement& s) {
  bool off = false, left = false;
  for (std::size_t i = 0; i < s.minor.size(); ++i) {
    const std::string& word = s.minor[i];
    off = off || word == "OFF";
    left = left || word == "CCLW";
    if (word == "RANGE" || word == "MAXRPM" || word == "RADIUS") {
      ++i;  // its number is not a speed
    } else if (const auto number = apt_number(word)) {
      if (*number < 0) throw ProgramFault{word, "the spindle speed must not be negative"};
      spindle_rpm_ = *number;
    } else if (word != "ON" && word != "OFF" && word != "CLW" && word != "CCLW" && word != "RPM" &&
               word != "NEUTRL" && word != "LOCK") {
      warn_once("SPINDL/" + word + " is not known and is left out");
    }
  }
  using Kind = MachineRemark::Kind;
  if (off) return sink_.remark({.kind = Kind::kSpindleStop});
  sink_.remark({.kind = left ? Kind::kSpindleCounterClockwise : Kind::kSpindleClockwise,
                .rpm = spindle_rpm_});
}

void AptMachine::coolant(const AptStatement& s) {
  const std::string mode = s.minor.empty() ? "ON" : s.minor[0];
  using Kind = MachineRemark::Kind;
  sink_.remark({.kind = mode == "OFF"    ? Kind::kCoolantOff
                        : mode == "MIST" ? Kind::kMist
                                         : Kind::kFlood});
}

void AptMachine::delay(const AptStatement& s) {
  if (s.minor.empty()) throw ProgramFault{s.major, "requires the seconds"};
  const double seconds = apt_number_of(s.minor[0]);
  if (seconds < 0) throw ProgramFault{s.minor[0], "the delay must not be negative"};
  if (sink_.placed()) require_tool();
  check(sink_.dwell(seconds, line_));
}

// TRNTYP/WORLD,0,0,0: points are in workpiece coordinates, whatever CSYS says.
void AptMachine::translation(const AptStatement& s) {
  in_world_ = !s.minor.empty() && s.minor[0] == "WORLD";
  for (std::size_t i = 1; i < s.minor.size(); ++i)
    if (apt_number_of(s.minor[i]) != 0)
      throw ProgramFault{s.major, "moves the coordinates, which is not supported"};
}

// Coordinates are in the first system. Another one would be another setup.
void AptMachine::system(const AptStatement& s) {
  if (in_world_ && s.major == "CSYS") return;
  std::string text = s.major;
  for (const std::string& word : s.minor)
    text += "," + decimal_text(apt_number(word).value_or(0), 9);
  if (!system_) system_ = text;
  if (*system_ != text)
    throw ProgramFault{
        s.major,
        "is another coordinate system than the first one, which is another setup and is "
        "not supported; post each setup as a program of its own"};
}

void AptMachine::cutter_offset(const AptStatement& s) {
  if (s.minor.empty() || s.minor[0] == "OFF" || s.minor[0] == "ON") return;
  warn_once("CUTCOM is read as wear of the tool: the points are those of its center");
}

}  // namespace kerf
