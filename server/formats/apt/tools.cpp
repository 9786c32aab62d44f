// SPDX-License-Identifier: Apache-2.0
#include "server/formats/apt/tools.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernel/tool/tool.h"
#include "server/formats/tool_words.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr double kLengthMm = 30;  ///< of a cutter without a length

// Flat, ball or bull-nosed, by its corner radius.
ToolShape milling_cutter(double d, double r, double length) {
  if (r <= 0) return FlatShape{d, length};
  if (r >= d / 2) return BallShape{d, length};
  return BullNoseShape{d, r, length};
}

bool is_load(const AptStatement& s) {
  return s.major == "LOADTL" || s.major == "TOOLNO" ||
         (s.major == "LOAD" && !s.minor.empty() && s.minor[0] == "TOOL");
}

std::optional<ToolId> loaded(const AptStatement& s) {
  const std::size_t at = s.major == "LOAD" ? 1 : 0;
  const auto number = at < s.minor.size() ? apt_number(s.minor[at]) : std::nullopt;
  if (!number || *number < 1 || *number > 4294967295.0 || *number != std::floor(*number))
    return std::nullopt;
  return static_cast<ToolId>(*number);
}

bool inches(const AptStatement& s) { return !s.minor.empty() && s.minor[0].starts_with("IN"); }

// The name of "TOOL PATH/CAVITY,TOOL,D10".
std::string path_tool(const AptStatement& s) {
  for (std::size_t i = 0; i + 1 < s.minor.size(); ++i)
    if (s.minor[i] == "TOOL") return s.minor[i + 1];
  return {};
}

class Finder {
 public:
  explicit Finder(std::string_view program) : program_(program) {}

  AptTools find() {
    each([this](const AptStatement& s, std::size_t) { found_.loads = found_.loads || is_load(s); });
    each([this](const AptStatement& s, std::size_t line) { read(s, line); });
    return std::move(found_);
  }

 private:
  template <typename Use>
  void each(Use use) const {
    AptStatements statements(program_);
    try {
      while (const auto statement = statements.next()) use(*statement, statements.line());
    } catch (const ProgramFault&) {
      return;  // read_apt reports it
    }
  }

  void read(const AptStatement& s, std::size_t line) {
    if (s.is_text) return;
    if (s.major == "UNITS" || s.major == "UNIT") unit_mm_ = inches(s) ? kMmPerInch : 1;
    if (is_load(s)) {
      if (const auto id = loaded(s)) load(*id);
    } else if (s.major == "TOOLPATH" && !found_.loads) {
      const std::string name = path_tool(s);
      const auto rank = static_cast<ToolId>(found_.ranks.size() + 1);
      if (!name.empty()) load(found_.ranks.try_emplace(name, rank).first->second);
    } else if (s.major == "CUTTER" || s.major == "TLDATA") {
      describe(s, line);
    } else if (s.major == "GOTO") {
      open_.reset();
      pending_.reset();
    }
  }

  void load(ToolId id) {
    AptTools::Tool& tool = found_.tools[id];
    if (pending_ && !tool.shape) tool = *pending_;
    open_ = pending_ ? std::nullopt : std::optional(id);
    pending_.reset();
  }

  void describe(const AptStatement& s, std::size_t line) {
    const auto cutter = apt_cutter(s, unit_mm_);
    if (!cutter) return;
    const AptTools::Tool stated{cutter->shape, line};
    if (!open_) {
      pending_ = stated;
    } else if (AptTools::Tool& tool = found_.tools[*open_]; !tool.shape) {
      tool = stated;
    }
  }

  std::string_view program_;
  AptTools found_;
  double unit_mm_ = 1;
  std::optional<ToolId> open_;
  std::optional<AptTools::Tool> pending_;
};

}  // namespace

std::optional<AptCutter> apt_cutter(const AptStatement& statement, double unit_mm) {
  std::vector<double> numbers;
  std::string kind;
  for (const std::string& word : statement.minor) {
    if (statement.major == "TLDATA" && !apt_number(word)) {
      if (kind.empty()) kind = word;
    } else {
      numbers.push_back(apt_number_of(word));
    }
  }
  if (numbers.empty()) return std::nullopt;
  const double d = numbers[0] * unit_mm;
  const double r = numbers.size() > 1 ? numbers[1] * unit_mm : 0;
  if (statement.major == "TLDATA") {
    const double length = numbers.size() > 2 && numbers[2] > 0 ? numbers[2] * unit_mm : kLengthMm;
    if (kind == "MILL") return AptCutter{d, milling_cutter(d, r, length)};
    if (kind != "DRILL") return std::nullopt;
    const double tip = numbers.size() > 3 && numbers[3] > 0 && numbers[3] < 180 ? numbers[3] : 118;
    return AptCutter{d, d > 0 ? drill_shape(d, tip) : ToolShape(FlatShape{d, length})};
  }
  if (numbers.size() >= 7) {
    const AptShape shape{d,          r,          numbers[2] * unit_mm, numbers[3] * unit_mm,
                         numbers[4], numbers[5], numbers[6] * unit_mm};
    if (make_tool(shape)) return AptCutter{d, shape};
  }
  return AptCutter{d, milling_cutter(d, r, kLengthMm)};
}

AptTools apt_tools(std::string_view program) { return Finder(program).find(); }

double apt_unit_mm(std::string_view program) {
  AptStatements statements(program);
  try {
    while (const auto s = statements.next())
      if (s->major == "UNITS" || s->major == "UNIT") return inches(*s) ? kMmPerInch : 1;
  } catch (const ProgramFault&) {
    return 1;  // read_apt reports it
  }
  return 1;
}

}  // namespace kerf
