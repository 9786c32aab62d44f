// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/formats/gcode/reader.h"
#include "tests/support/test.h"

namespace kerf::test {

/// Records the canonical calls of a program.
class CanonRecord final : public GcodeCanon {
 public:
  struct Call {
    char kind;  ///< 'R'apid, 'F'eed, 'A'rc, 'S'pline, 'D'well, 'T'ool
    Vec3 to;    ///< absolute coordinates
    std::size_t line = 0;
    double value = 0;  ///< feed in mm/min, seconds, turns or the tool number
  };
  std::vector<Call> calls;

  void at_line(std::size_t, std::size_t line) override { line_ = line; }
  void rapid(const GcodePlace& to, GcodeRapid, std::array<bool, 6>) override { add('R', to, 0); }
  void feed(const GcodePlace& to, const GcodeFeed& feed, std::array<bool, 6>) override {
    add('F', to, feed.mm_per_min);
  }
  void arc(const Arc& arc, const GcodeFrame&, const GcodePlace& to, const GcodeFeed&,
           std::array<bool, 6>) override {
    add('A', to, arc.turns);
  }
  void spline(const std::vector<Vec3>&, const GcodeFrame&, const GcodePlace& to, const GcodeFeed&,
              std::array<bool, 6>) override {
    add('S', to, 0);
  }
  void dwell(double seconds) override { calls.push_back({'D', {}, line_, seconds}); }
  void change_tool(std::optional<ToolId> tool) override {
    calls.push_back({'T', {}, line_, static_cast<double>(tool.value_or(0))});
  }
  void offset_tool(const GcodeAxes&, const GcodePlace&) override {}
  GcodePlace control_tool_center(bool, const GcodePlace& at) override { return at; }

 private:
  void add(char kind, const GcodePlace& to, double value) {
    calls.push_back({kind, linear(to.axes), line_, value});
  }
  std::size_t line_ = 0;
};

inline GcodeSetup machine_with(ToolTable tools = {}, Dialect dialect = Dialect::kLinuxcnc) {
  return GcodeSetup{.machine_name = "xyzabc",
                    .tools = std::move(tools),
                    .rules = rules_of(dialect),
                    .machine_zero_known = true};
}

/// A table of tools 1 to 3 with diameters of 2, 4 and 6 mm and lengths of 10, 20 and 30 mm.
inline ToolTable three_tools() {
  ToolTable tools;
  for (const int n : {1, 2, 3})
    tools[n] = {.number = n, .pocket = n + 10, .offset = {0, 0, 10.0 * n}, .diameter_mm = 2.0 * n};
  return tools;
}

/// Returns the calls of a program that must be valid.
inline std::vector<CanonRecord::Call> calls_of(const std::string& text,
                                               const GcodeEnvironment& environment = {}) {
  CanonRecord record;
  const auto run =
      run_gcode("p.ngc", text, environment, machine_with(three_tools(), environment.dialect),
                record, [](const std::string&) {});
  EXPECT_TRUE(run.has_value()) << to_string(run.error()) << "\n" << text;
  return record.calls;
}

/// Returns kind and end of each motion and the seconds of each dwell: "R 1 2 3, F 1 2 0, D 0.5".
inline std::string moves_of(const std::string& text, const GcodeEnvironment& environment = {}) {
  std::string moves;
  const auto number = [](double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, " %.10g", std::round(value * 1e9) / 1e9 + 0.0);
    return std::string(buffer);
  };
  for (const CanonRecord::Call& call : calls_of(text, environment)) {
    if (call.kind == 'T') continue;
    if (!moves.empty()) moves += ", ";
    moves += call.kind;
    moves += call.kind == 'D' ? number(call.value)
                              : number(call.to.x) + number(call.to.y) + number(call.to.z);
  }
  return moves;
}

/// Returns the error of a program that must be invalid.
inline ProgramError run_error_of(const std::string& text,
                                 const GcodeEnvironment& environment = {}) {
  CanonRecord record;
  const auto run =
      run_gcode("p.ngc", text, environment, machine_with(three_tools(), environment.dialect),
                record, [](const std::string&) {});
  EXPECT_FALSE(run.has_value()) << text;
  return run ? ProgramError{} : run.error();
}

}  // namespace kerf::test
