// SPDX-License-Identifier: Apache-2.0
#include "server/formats/apt_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "server/formats/letter_case.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/motion_sink.h"
#include "server/formats/number_text.h"
#include "server/formats/text_lines.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

// Greatest difference without a warning between the diameters of CUTTER and of the scene's tool.
constexpr double kCutterDifferenceMm = 1e-3;
// Shortest tool axis vector that has a direction.
constexpr double kAxisLengthMin = 1e-6;

// The diameter as CUTTER defines it: at the intersection of bottom and side line.
double diameter_mm(const SceneTool& tool) {
  if (const auto* apt = std::get_if<AptShape>(&tool.shape)) return apt->d_mm;
  return 2 * tool.tool.radius_mm;
}

constexpr std::array kSpindleWords{"ON", "OFF", "CLW", "CCLW", "RPM", "NEUTRL", "LOCK"};
constexpr std::array kCoolantWords{"ON", "OFF", "MIST", "FLOOD", "THRU"};

// Thrown for an invalid statement; AptReader::step adds file and line. Never leaves this file.
struct Fault {
  std::string word, reason;
};

struct Statement {
  std::string major;               ///< upper case
  std::vector<std::string> minor;  ///< values after '/', upper case, without blanks
};

std::string clean(std::string_view text) {
  std::string result;
  for (const char c : text)
    if (c != ' ' && c != '\t' && c != '\r') result += to_upper(c);
  return result;
}

Statement parse_statement(const std::string& text) {
  Statement statement;
  const std::size_t slash = text.find('/');
  statement.major = text.substr(0, slash);
  if (slash == std::string::npos) return statement;
  std::size_t from = slash + 1;
  while (true) {
    const std::size_t comma = text.find(',', from);
    statement.minor.push_back(text.substr(from, comma - from));
    if (comma == std::string::npos) return statement;
    from = comma + 1;
  }
}

std::optional<double> as_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
  if (read.ec != std::errc{} || read.ptr != word.data() + word.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

double number(const std::string& word) {
  const auto value = as_number(word);
  if (!value) throw Fault{word, word.empty() ? "a number is missing" : "is not a number"};
  return *value;
}

enum class FeedUnit { kPerMinute, kPerRevolution };

class AptReader final : public ProgramReader {
 public:
  AptReader(std::string name, std::string_view text, const Scene& scene)
      : scene_(scene), sink_(program_), lines_(text) {
    program_.name = std::move(name);
    program_.files = {program_.name};
  }

  std::expected<bool, ProgramError> step() override {
    try {
      if (lines_.next()) {
        line_ = lines_.number();
        read_line(lines_);
        if (!finished_) return true;
      }
      if (!finished_) warn("the program ends without FINI");
    } catch (const Fault& fault) {
      return std::unexpected(ProgramError{program_.name, line_, fault.word, fault.reason});
    }
    program_.lines = line_;
    return false;
  }

 private:
  // Statements whose text is free, including '$' and '/'.
  static bool is_text(const std::string& statement) {
    return statement.starts_with("PARTNO") || statement.starts_with("PPRINT") ||
           statement.starts_with("REMARK");
  }

  void read_line(TextLines& lines) {
    std::string text = clean(lines.line());
    if (is_text(text)) {
      if (text.starts_with("PPRINT")) remark_text(text.substr(std::string_view("PPRINT").size()));
      return;
    }
    while (true) {
      if (const std::size_t comment = text.find("$$"); comment != std::string::npos)
        text.erase(comment);
      if (!text.ends_with('$')) break;
      text.pop_back();
      if (!lines.next()) throw Fault{"$", "the statement is continued, but the file ends"};
      text += clean(lines.line());
    }
    if (text.empty()) return;
    const Statement statement = parse_statement(text);
    const auto handler = std::find_if(kStatements.begin(), kStatements.end(),
                                      [&](const auto& h) { return h.first == statement.major; });
    if (handler == kStatements.end())
      throw Fault{statement.major, "is not a supported APT statement"};
    (this->*handler->second)(statement);
  }

  void warn(const std::string& text) {
    if (program_.warnings.size() < kProgramWarningsMax)
      program_.warnings.push_back(program_.name + ":" + std::to_string(line_) + ": " + text);
  }

  static void check_count(const Statement& s, std::size_t least, std::size_t most) {
    if (s.minor.size() < least || s.minor.size() > most)
      throw Fault{s.major, "has " + std::to_string(s.minor.size()) + " values; it takes " +
                               std::to_string(least) +
                               (least == most ? "" : " to " + std::to_string(most))};
  }

  static void check(const MotionSink::Result& result) {
    if (!result) throw Fault{"", result.error()};
  }

  void ignore(const Statement&) {}
  void stop(const Statement& s) {
    sink_.remark({.kind = s.major == "STOP" ? MachineRemark::Kind::kStop
                                            : MachineRemark::Kind::kOptionalStop});
  }
  void remark_text(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(" /"), text.size()));
    sink_.remark({.text = std::string(text)});
  }
  void fini(const Statement&) { finished_ = true; }

  void units(const Statement& s) {
    check_count(s, 1, 1);
    if (s.minor[0] == "MM") {
      unit_mm_ = 1;
    } else if (s.minor[0] == "INCHES" || s.minor[0] == "INCH") {
      unit_mm_ = kMmPerInch;
    } else {
      throw Fault{s.minor[0], "is not a unit; use MM or INCHES"};
    }
  }

  void multax(const Statement& s) {
    check_count(s, 0, 1);
    if (!s.minor.empty() && s.minor[0] != "ON" && s.minor[0] != "OFF")
      throw Fault{s.minor[0], "must be ON or OFF"};
    multiaxis_ = s.minor.empty() || s.minor[0] == "ON";
  }

  void load_tool(const Statement& s) {
    check_count(s, 1, 1);
    const double id = number(s.minor[0]);
    if (id < 1 || id > 4294967295.0 || id != std::floor(id) ||
        !scene_.tools.contains(static_cast<ToolId>(id)))
      throw Fault{s.minor[0], "is not the id of a tool of the scene"};
    sink_.change_tool(static_cast<ToolId>(id), line_);
  }

  void cutter(const Statement& s) {
    check_count(s, 1, 7);
    for (const std::string& word : s.minor) number(word);
    const double diameter = number(s.minor[0]) * unit_mm_;
    if (diameter <= 0) throw Fault{s.minor[0], "the diameter of a cutter must be above 0"};
    if (!sink_.tool()) return;
    const double loaded = diameter_mm(scene_.tools.at(*sink_.tool()));
    if (std::abs(diameter - loaded) > kCutterDifferenceMm)
      warn("CUTTER has a diameter of " + decimal_text(diameter, 6) + " mm, but tool " +
           std::to_string(*sink_.tool()) + " of the scene, which is used, has " +
           decimal_text(loaded, 6) + " mm");
  }

  void feed_rate(const Statement& s) {
    check_count(s, 1, 2);
    std::optional<double> value;
    double unit = unit_mm_;
    FeedUnit per = FeedUnit::kPerMinute;
    for (const std::string& word : s.minor) {
      if (word == "MMPM" || word == "MMPR") {
        unit = 1;
        per = word == "MMPM" ? FeedUnit::kPerMinute : FeedUnit::kPerRevolution;
      } else if (word == "IPM" || word == "IPR") {
        unit = kMmPerInch;
        per = word == "IPM" ? FeedUnit::kPerMinute : FeedUnit::kPerRevolution;
      } else if (word == "PERMIN" || word == "PERREV") {
        per = word == "PERMIN" ? FeedUnit::kPerMinute : FeedUnit::kPerRevolution;
      } else if (value) {
        throw Fault{word, "is not a feed unit; use MMPM, MMPR, IPM, IPR, PERMIN or PERREV"};
      } else {
        value = number(word);
      }
    }
    if (!value || *value <= 0) throw Fault{"FEDRAT", "must give a feed above 0"};
    feed_ = *value;
    feed_mm_ = *value * unit;
    feed_unit_ = per;
    rapid_ = false;
  }

  void rapid(const Statement& s) {
    check_count(s, 0, 0);
    rapid_ = true;
  }

  void spindle(const Statement& s) {
    check_count(s, 1, 4);
    bool off = false, left = false;
    for (const std::string& word : s.minor) {
      off = off || word == "OFF";
      left = left || word == "CCLW";
      if (std::find(kSpindleWords.begin(), kSpindleWords.end(), word) != kSpindleWords.end())
        continue;
      spindle_rpm_ = number(word);
      if (spindle_rpm_ < 0) throw Fault{word, "the spindle speed must not be negative"};
    }
    using Kind = MachineRemark::Kind;
    if (off) return sink_.remark({.kind = Kind::kSpindleStop});
    sink_.remark({.kind = left ? Kind::kSpindleCounterClockwise : Kind::kSpindleClockwise,
                  .rpm = spindle_rpm_});
  }

  void coolant(const Statement& s) {
    check_count(s, 1, 1);
    if (std::find(kCoolantWords.begin(), kCoolantWords.end(), s.minor[0]) == kCoolantWords.end())
      throw Fault{s.minor[0], "is not a coolant mode; use ON, OFF, MIST, FLOOD or THRU"};
    using Kind = MachineRemark::Kind;
    sink_.remark({.kind = s.minor[0] == "OFF"    ? Kind::kCoolantOff
                          : s.minor[0] == "MIST" ? Kind::kMist
                                                 : Kind::kFlood});
  }

  void delay(const Statement& s) {
    check_count(s, 1, 1);
    const double seconds = number(s.minor[0]);
    if (seconds < 0) throw Fault{s.minor[0], "the delay must not be negative"};
    if (sink_.placed()) require_tool();
    check(sink_.dwell(seconds, line_));
  }

  ToolPose read_pose(const Statement& s) {
    if (s.minor.size() != 3 && s.minor.size() != 6)
      throw Fault{s.major, "has " + std::to_string(s.minor.size()) +
                               " values; it takes x,y,z or x,y,z,i,j,k"};
    ToolPose pose{{number(s.minor[0]) * unit_mm_, number(s.minor[1]) * unit_mm_,
                   number(s.minor[2]) * unit_mm_},
                  axis_};
    if (s.minor.size() == 6) {
      if (!multiaxis_) throw Fault{s.major, "has a tool axis, which requires MULTAX/ON before it"};
      pose.axis = {number(s.minor[3]), number(s.minor[4]), number(s.minor[5])};
      const double size = length(pose.axis);
      if (!(size > kAxisLengthMin) || !std::isfinite(size))
        throw Fault{s.major, "the tool axis i,j,k must be a finite vector other than 0,0,0"};
      const bool tilted = pose.axis.x != 0 || pose.axis.y != 0 || pose.axis.z < 0;
      if (tilted && scene_.machine.kinematics == MachineKinematics::kXyz)
        throw Fault{s.major, "tilts the tool, which the scene's machine xyz cannot do"};
    }
    return pose;
  }

  void from(const Statement& s) {
    const ToolPose pose = read_pose(s);
    check(sink_.place(pose));
    axis_ = pose.axis;
  }

  void go_to(const Statement& s) { move(read_pose(s)); }

  void go_delta(const Statement& s) {
    if (!sink_.placed()) throw Fault{s.major, "requires FROM or GOTO before it"};
    ToolPose pose = *sink_.last();
    if (s.minor.size() == 1) {
      pose.tip_mm = pose.tip_mm + normalized(pose.axis) * (number(s.minor[0]) * unit_mm_);
    } else {
      check_count(s, 3, 3);
      pose.tip_mm =
          pose.tip_mm + Vec3{number(s.minor[0]), number(s.minor[1]), number(s.minor[2])} * unit_mm_;
    }
    move(pose);
  }

  void require_tool() {
    if (sink_.tool()) return;
    if (scene_.tools.size() != 1)
      throw Fault{"", "no tool is loaded and the scene has several; load one with LOADTL"};
    warn("no tool is loaded; the scene's only tool is used");
    sink_.set_tool(scene_.tools.begin()->first);
  }

  void move(const ToolPose& to) {
    require_tool();
    if (!sink_.placed()) {
      check(sink_.place(to));
    } else {
      check(sink_.line(to, duration_s(*sink_.last(), to), rapid_, line_));
    }
    axis_ = to.axis;
    rapid_ = false;
  }

  double duration_s(const ToolPose& from, const ToolPose& to) const {
    const FeedTravel path = feed_travel(from, to);
    const double travel = path.length();
    if (rapid_) return 60 * travel / scene_.machine.rapid_mm_per_min;
    const double feed = path.mm > 0 ? feed_mm_ : feed_;
    if (feed <= 0) throw Fault{"", "the feed is 0; give FEDRAT before the first cutting motion"};
    if (feed_unit_ == FeedUnit::kPerMinute) return 60 * travel / feed;
    if (spindle_rpm_ <= 0)
      throw Fault{"", "a feed per revolution requires a spindle speed; give SPINDL before it"};
    return 60 * travel / (feed * spindle_rpm_);
  }

  using Handler = void (AptReader::*)(const Statement&);
  static const std::array<std::pair<std::string_view, Handler>, 16> kStatements;

  const Scene& scene_;
  MotionSink sink_;
  TextLines lines_;
  std::size_t line_ = 0;
  bool finished_ = false;
  double unit_mm_ = 1;
  bool multiaxis_ = false;
  bool rapid_ = false;
  double feed_ = 0;     ///< as written: degrees per minute if only the axis turns
  double feed_mm_ = 0;  ///< in mm
  FeedUnit feed_unit_ = FeedUnit::kPerMinute;
  double spindle_rpm_ = 0;
  Vec3 axis_{0, 0, 1};
};

const std::array<std::pair<std::string_view, AptReader::Handler>, 16> AptReader::kStatements{{
    {"UNITS", &AptReader::units},
    {"MULTAX", &AptReader::multax},
    {"LOADTL", &AptReader::load_tool},
    {"CUTTER", &AptReader::cutter},
    {"FEDRAT", &AptReader::feed_rate},
    {"RAPID", &AptReader::rapid},
    {"SPINDL", &AptReader::spindle},
    {"COOLNT", &AptReader::coolant},
    {"DELAY", &AptReader::delay},
    {"FROM", &AptReader::from},
    {"GOTO", &AptReader::go_to},
    {"GODLTA", &AptReader::go_delta},
    {"STOP", &AptReader::stop},
    {"OPSTOP", &AptReader::stop},
    {"END", &AptReader::ignore},
    {"FINI", &AptReader::fini},
}};

}  // namespace

std::expected<ReadProgram, ProgramError> read_apt(const std::string& name, std::string_view text,
                                                  const Scene& scene, ProgramVisitor& visitor) {
  return read_to_end(
      [name, text, &scene] { return std::make_unique<AptReader>(name, text, scene); }, visitor);
}

}  // namespace kerf
