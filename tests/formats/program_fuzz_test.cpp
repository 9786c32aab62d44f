// SPDX-License-Identifier: Apache-2.0
#include "kernel/math/rotation.h"
#include "server/formats/gcode/parameter_file.h"
#include "server/formats/pose_grid.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::program_fuzz_test {
namespace {

using test::scene_for;

const char* const kGcodeSeed =
    "%\n(a program)\n#<scale> = 1.5\n#1=[#<scale>*2 + sin[30]]\nN10 G21 G90 G94 G64 P0.1\n"
    "T1 M6\nM428\nG0 X0 Y0 Z5 A0 C0\nG1 Z-1 F300\nX[#1*2] Y#1 A-5.5 C-25.6\nX0 Y0\nG2 X5 Y5 I2.5 "
    "J2.5\n"
    "G18 G3 X0 Z0 R10\nG17 G93\nG1 X3 C90 F60\nG94 G91 G1 X1 F100\nG90 G92 X5\nG10 L2 P2 X1\n"
    "G55 G1 X2\nG4 P0.1\nG53 G0 Z0\nM429\n/G1 X5\nG28\nM30\n%\n";
// Control flow, cycles, compensation, tools and named parameters.
const char* const kControllerSeed =
    "%\n#<_width>=4\nG21 G90 F300\nT1 M6\nS500 M3\nG43 H1\nG0 X0 Y0 Z5\no<hole> "
    "sub\n#<r>=[#3/2]\no1 if [#<r> "
    "gt 1]\nG81 X#1 Y#2 Z-1 R1\no1 elseif [#<r> lt 0]\no<hole> return [1]\no1 else\nG83 X#1 Y#2 "
    "Z-2 R1 "
    "Q0.7\no1 endif\nG80\no<hole> endsub [#1+1]\n#9=0\no2 while [#9 lt 3]\n#9=[#9+1]\no3 if [#9 eq "
    "2]\no2 continue\no3 endif\no<hole> call [#9] [#<_value>] [#9]\no2 endwhile\no4 repeat "
    "[2]\nG91 G1 "
    "X1\nG90\no4 endrepeat\no5 do\n#9=[#9-1]\no5 while [#9 gt 0]\nG0 X-20 Y0\nG41.1 D2\nG1 X-10 "
    "Y0\nG1 Y20\nG2 X10 Y20 R10\nG1 Y0\nG40 G0 Z5\nG0 @5 ^30\nG10 L2 P2 X1 R15\nG55 G0 X1\nG10 L1 "
    "P1 "
    "Z3\nG43.1 Z1\nG52 X1\nM70\nG20\nM72\nM98 P7 L2\nG5.1 X1 Y1 I1 J2\nG17 G33.1 Z-1 "
    "K0.5\nM2\nO7\nG1 "
    "X#<_x>\nM99\n";
// Macro B, transforms, corners and further work offsets.
const char* const kMacroSeed =
    "%\nO1000 (A (NESTED) NAME)\nG21 G90 G94 T1 M6\nG54.1 P2 G0 X0 Y0 Z5\nG43 H1 S900 M3\n#1=0\n"
    "WHILE[#1LT3]DO1\n#1=#1+1\nG1 Z-#1 F300\nG68 X1 Y2 R[30*#1]\nX5 Y5 ,R1\nX9 Y2\nG69\nG65 "
    "P2000 A#1 B2. I1 I2\nIF[#1EQ2]THEN #100=7\nEND1\nM98 P2001 L2\nG51.1 X3\nG1 X1 Y1\nG2 X3 Y1 "
    "I1 J0 K0\nG50.1 X0\nG16\nG98 G81 X9 Y30 Z-1 R1 K2\nY60\nG80 G15\nG10 L2 P2 X1.\nG55 G0 X1 "
    "Y1\nG4 "
    "P500\nG91 G28 Z0 M131\nGOTO99\nG0 X77\nN99 M30\nO2000\nIF[#1EQ#0]GOTO5\nG0 X#1 Y[#2 "
    "OR 1]\nN5 M99\nO2001\nG91 G1 X1\nG90\nM99\n%\n";
const char* const kAptSeed =
    "PARTNO/FUZZ\nUNITS/MM\nMULTAX/ON\nCUTTER/10,5\nLOADTL/1\nSPINDL/1000,CLW\nCOOLNT/ON\n"
    "FEDRAT/6000,MMPM\nFROM/0,0,10\nGOTO/1,2,3,0,0.6,0.8\nRAPID\nGODLTA/0,0,-1\nGODLTA/5\n"
    "GOTO/1,$\n2,3\nDELAY/1\n$$ comment\nEND\nFINI\n";
const char* const kSceneSeed =
    R"({"name": "s", "stock": {"shape": "box", "min_mm": [0,0,0], "max_mm": [1,1,1]},
 "accuracy": {"rays": "dexel", "pitch_mm": 0.25}, "machine": {"kinematics": "xyz"},
 "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60}],
 "obstacles": [{"shape": "sphere", "center_mm": [0,0,0], "radius_mm": 1}]})";

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// Applies a few random changes of bytes, words or lines, determined by the seed.
std::string mutated(const std::string& text, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto below = [&random](std::size_t n) { return n == 0 ? 0 : random() % n; };
  static const char kBytes[] =
      "GMXYZABCIJKRPFSTLHNO#<>[]()=+-*/%;.,@^$0123456789 \n\r\t\"{}:$e\x00\xff";
  std::string result = text;
  for (std::size_t i = 1 + below(4); i > 0; --i) {
    const std::size_t at = below(result.size());
    const char byte = kBytes[below(sizeof kBytes)];
    switch (below(6)) {
      case 0:
        result.insert(at, 1, byte);
        break;
      case 1:
        result.erase(at, 1 + below(5));
        break;
      case 2:
        result.insert(at, std::string(1 + below(300), byte));
        break;
      case 3:
        result.insert(at, std::to_string(std::exp(static_cast<double>(below(90)))));
        break;
      case 4: {
        std::vector<std::string> lines = lines_of(result);
        if (lines.size() > 1) std::swap(lines[below(lines.size())], lines[below(lines.size())]);
        result.clear();
        for (const std::string& line : lines) result.append(line).append("\n");
        break;
      }
      default:
        if (!result.empty()) result[at] = byte;
    }
  }
  return result;
}

void expect_valid(const std::expected<Program, ProgramError>& program, std::uint64_t seed) {
  if (!program) {
    EXPECT_FALSE(program.error().reason.empty()) << "seed " << seed;
    EXPECT_EQ(to_string(program.error()).find('\n'), std::string::npos) << "seed " << seed;
    return;
  }
  for (const ProgramMotion& m : program->motions) {
    ASSERT_TRUE(is_finite(m.to.tip_mm) && is_finite(m.to.axis)) << "seed " << seed;
    ASSERT_EQ(admit_pose(m.to), m.to) << "seed " << seed;
    ASSERT_EQ(admit_pose(m.from), m.from) << "seed " << seed;
    ASSERT_GT(m.duration_s, 0) << "seed " << seed;
    ASSERT_LE(m.duration_s, 1e9) << "seed " << seed;
    ASSERT_LE(angle_between(normalized(m.from.axis), normalized(m.to.axis)), kTurnMaxRad)
        << "seed " << seed;
  }
}

TEST(ProgramFuzz, GcodeGivesValidMotionsOrAnError) {
  const Scene scene = scene_for("xyzac-trt");
  expect_valid(parse_program("p.ngc", kGcodeSeed, scene), 0);
  ASSERT_TRUE(parse_program("p.ngc", kGcodeSeed, scene).has_value());
  for (std::uint64_t seed = 1; seed <= 6000; ++seed)
    expect_valid(parse_program("p.ngc", mutated(kGcodeSeed, seed), scene), seed);
}

TEST(ProgramFuzz, SubroutinesAndCyclesTerminateWithValidMotionsOrAnError) {
  const Scene scene = scene_for("xyz");
  GcodeEnvironment environment{.lines_max = 5000};
  const auto whole = test::value_of(parse_program("p.ngc", kControllerSeed, scene, environment));
  ASSERT_GT(whole.motions.size(), 40u);
  for (std::uint64_t seed = 1; seed <= 3000; ++seed)
    expect_valid(parse_program("p.ngc", mutated(kControllerSeed, seed), scene, environment), seed);
}

TEST(ProgramFuzz, MacroProgramsAreReadOrRejected) {
  const Scene scene = scene_for("xyz");
  GcodeEnvironment environment{.lines_max = 20'000};
  const auto whole = parse_program("p.nc", kMacroSeed, scene, environment);
  ASSERT_TRUE(whole.has_value()) << to_string(whole.error());
  for (std::uint64_t seed = 1; seed <= 3000; ++seed)
    expect_valid(parse_program("p.nc", mutated(kMacroSeed, seed), scene, environment), seed);
}

TEST(ProgramFuzz, ToolTablesAndParameterFilesAreReadOrRejected) {
  const std::string table = "T1 P1 D0.5 Z+1.25 ; mill\nT2 P2 D.25 X1 I10 J20 Q3\n";
  const std::string parameters = "5161 1.5\n5162 -2e3\n5220 1\n5221 0.25\n5230 15\n";
  for (std::uint64_t seed = 1; seed <= 6000; ++seed) {
    const auto tools = read_tool_table("t.tbl", mutated(table, seed), 25.4);
    for (const auto& [number, tool] : tools.value_or(ToolTable{}))
      ASSERT_TRUE(std::isfinite(tool.diameter_mm) && std::isfinite(tool.offset[2])) << seed;
    const auto read = read_parameter_file("p.var", mutated(parameters, seed));
    for (const auto& [number, value] : read.value_or(std::map<int, double>{}))
      ASSERT_TRUE(std::isfinite(value)) << seed;
  }
}

TEST(ProgramFuzz, AptGivesValidMotionsOrAnError) {
  const Scene scene = scene_for("tool-vector");
  ASSERT_TRUE(parse_program("p.apt", kAptSeed, scene).has_value());
  for (std::uint64_t seed = 1; seed <= 6000; ++seed)
    expect_valid(parse_program("p.apt", mutated(kAptSeed, seed), scene), seed);
}

TEST(ProgramFuzz, ScenesAreReadOrRejected) {
  ASSERT_TRUE(parse_scene(kSceneSeed, {}).has_value());
  for (std::uint64_t seed = 1; seed <= 6000; ++seed) {
    const auto scene = parse_scene(mutated(kSceneSeed, seed), {});
    if (!scene) {
      EXPECT_FALSE(scene.error().reason.empty()) << "seed " << seed;
    } else {
      EXPECT_TRUE(parse_scene(scene_json(*scene), {}).has_value()) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace kerf::program_fuzz_test
