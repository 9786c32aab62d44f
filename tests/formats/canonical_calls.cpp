// SPDX-License-Identifier: Apache-2.0
// canonical_calls [--tools TABLE] [--parameters FILE] [--folder DIR]... PROGRAM
// Prints the canonical calls of Kerf's G-code reader for an inch machine with the axes X Y Z A B C,
// one per line, in mm and degrees, in absolute coordinates:
//   rapid LINE x y z a b c
//   feed LINE x y z a b c
//   arc LINE x y z a b c plane first second turns
//   spline LINE x y z a b c
//   dwell LINE seconds
//   tool LINE number
// followed by "warning: …" for each warning and "error: …" if the program is invalid.
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "server/formats/gcode/parameter_file.h"
#include "server/formats/gcode/reader.h"
#include "server/formats/text_file.h"
#include "server/formats/units.h"

namespace {

using namespace kerf;

class PrintedCalls final : public GcodeCanon {
 public:
  void at_line(std::size_t, std::size_t line) override { line_ = line; }
  void rapid(const GcodePlace& to, GcodeRapid, std::array<bool, 6>) override {
    place("rapid", to);
    std::putchar('\n');
  }
  void feed(const GcodePlace& to, const GcodeFeed&, std::array<bool, 6>) override {
    place("feed", to);
    std::putchar('\n');
  }
  void arc(const Arc& arc, const GcodeFrame& frame, const GcodePlace& to, const GcodeFeed&,
           std::array<bool, 6>) override {
    place("arc", to);
    GcodeAxes middle{};
    set_linear(middle, from_plane({arc.center_first, arc.center_second, 0}, arc.plane));
    const PlanePoint center = in_plane(linear(frame.absolute(middle)), arc.plane);
    std::printf(" %d %.9f %.9f %d\n", static_cast<int>(arc.plane), center.first, center.second,
                arc.turns);
  }
  void spline(const std::vector<Vec3>&, const GcodeFrame&, const GcodePlace& to, const GcodeFeed&,
              std::array<bool, 6>) override {
    place("spline", to);
    std::putchar('\n');
  }
  void dwell(double seconds) override { std::printf("dwell %zu %.9f\n", line_, seconds); }
  void change_tool(std::optional<ToolId> tool) override {
    std::printf("tool %zu %u\n", line_, tool.value_or(0));
  }
  void offset_tool(const GcodeAxes&, const GcodePlace&) override {}
  GcodePlace control_tool_center(bool, const GcodePlace& at) override { return at; }

 private:
  void place(const char* kind, const GcodePlace& to) const {
    std::printf("%s %zu", kind, line_);
    for (const double value : to.axes) std::printf(" %.9f", value);
  }
  std::size_t line_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  // The same machine as in rs274: its unit is the inch, and programs start in mm.
  GcodeEnvironment environment{.dialect = Dialect::kLinuxcnc, .machine_unit_mm = kMmPerInch};
  environment.parameters.emplace();
  std::string program;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (i + 1 < argc && option == "--folder") {
      environment.subroutine_folders.emplace_back(argv[++i]);
    } else if (i + 1 < argc && (option == "--tools" || option == "--parameters")) {
      const std::string name = argv[++i];
      const auto text = read_file(name);
      if (!text) return 2;
      if (option == "--tools") {
        auto table = read_tool_table(name, *text, environment.machine_unit_mm);
        if (!table) return 2;
        environment.tools = *std::move(table);
      } else {
        auto parameters = read_parameter_file(name, *text);
        if (!parameters) return 2;
        environment.parameters = *std::move(parameters);
      }
    } else {
      program = option;
    }
  }
  const auto text = read_file(program);
  if (!text) return 2;
  GcodeSetup setup{.machine_name = "xyzabc"};
  if (environment.tools) setup.tools = *environment.tools;
  setup.machine_unit_mm = environment.machine_unit_mm;
  setup.machine_zero_known = true;
  PrintedCalls calls;
  std::vector<std::string> warnings;
  const auto run = run_gcode(program, *text, environment, std::move(setup), calls,
                             [&](const std::string& warning) { warnings.push_back(warning); });
  for (const std::string& warning : warnings) std::printf("warning: %s\n", warning.c_str());
  if (run) return 0;
  std::printf("error: %s\n", to_string(run.error()).c_str());
  return 1;
}
