// SPDX-License-Identifier: Apache-2.0
#include "server/formats/post.h"

#include "server/formats/pose_grid.h"
#include "server/formats/program_writer.h"
#include "tests/formats/post_fixture.h"
#include "tests/support/test.h"

namespace kerf::post_test {
namespace {

using test::kPosts;
using test::read_back;
using test::scene_for;
using test::text_of;
using testing::HasSubstr;

// Strokes of two tools with jumps, rests and rapids, whose numbers have `decimals` decimals.
Program random_program(std::uint64_t seed, bool tilt, int decimals) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  const double unit = std::pow(10.0, decimals);
  const auto coordinate = [&] { return std::round(any(random) * 60 * unit) / unit; };
  const auto pose = [&] {
    const Vec3 axis = tilt ? Vec3{any(random), any(random), any(random) + 1.2} : Vec3{0, 0, 1};
    const double x = coordinate(), y = coordinate();
    return admit_pose({Vec3{x, y, coordinate()}, axis});
  };
  Program program;
  ToolPose at = pose();
  ToolId tool = 1;
  for (int i = 0; i < 40; ++i) {
    const double chance = any(random);
    if (chance > 0.8) at = pose();
    if (chance < -0.8) tool = 3 - tool;
    const ToolPose to = any(random) > 0.9 ? at : pose();
    program.motions.push_back({.tool = tool,
                               .from = at,
                               .to = to,
                               .duration_s = 0.5 + std::abs(any(random)),
                               .rapid = !(to == at) && any(random) > 0.5});
    at = to;
  }
  return program;
}

double off_mm(const ToolPose& a, const ToolPose& b) {
  const Vec3 d = a.tip_mm - b.tip_mm;
  return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
}

TEST(Post, ThreeDecimalsReadBackToTheSameProgram) {
  const Scene scene = scene_for("xyz");
  for (const Post post : kPosts)
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const Program program = random_program(seed, false, 3);
      const std::string text = text_of(program, scene, post);
      const Program read = read_back(scene, text, post);
      ASSERT_EQ(read.motions.size(), program.motions.size()) << text;
      for (std::size_t i = 0; i < read.motions.size(); ++i) {
        ASSERT_EQ(read.motions[i].from, program.motions[i].from) << i << "\n" << text;
        ASSERT_EQ(read.motions[i].to, program.motions[i].to) << i << "\n" << text;
        ASSERT_EQ(read.motions[i].tool, program.motions[i].tool) << i << "\n" << text;
        ASSERT_EQ(read.motions[i].rapid, program.motions[i].rapid) << i << "\n" << text;
        if (program.motions[i].rapid) continue;
        ASSERT_NEAR(read.motions[i].duration_s / program.motions[i].duration_s, 1, 1e-3) << text;
      }
    }
}

TEST(Post, NumbersAreRoundedToTheControlsDecimals) {
  const Scene scene = scene_for("xyz");
  for (const Post post : kPosts) {
    const double half = 0.5 * std::pow(10.0, -rules_of(post).tip_decimals) + 1e-9;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const Program program = random_program(seed, false, 6);
      const Program read = read_back(scene, text_of(program, scene, post), post);
      ASSERT_EQ(read.motions.size(), program.motions.size());
      for (std::size_t i = 0; i < read.motions.size(); ++i) {
        ASSERT_LE(off_mm(read.motions[i].from, program.motions[i].from), half);
        ASSERT_LE(off_mm(read.motions[i].to, program.motions[i].to), half);
      }
    }
  }
}

// Samples of a hand at rest are shorter than the last decimal. Their time is not lost.
TEST(Post, MotionsBelowTheLastDecimalAreAddedToTheNext) {
  const Scene scene = scene_for("xyz");
  Program program;
  for (int n = 0; n < 10'000; ++n)
    program.motions.push_back({.tool = 1,
                               .from = {{n * 1e-4, 0, 0}, {0, 0, 1}},
                               .to = {{(n + 1) * 1e-4, 0, 0}, {0, 0, 1}},
                               .duration_s = 0.001});
  const std::string text = text_of(program, scene, Post::kFanuc);
  EXPECT_LT(std::ranges::count(text, '\n'), 1100);  // a thousand motions of 0.001 mm, not 10,000
  const Program read = read_back(scene, text, Post::kFanuc);
  double seconds = 0;
  for (const ProgramMotion& motion : read.motions) seconds += motion.duration_s;
  EXPECT_NEAR(seconds, 10, 0.02);
  EXPECT_EQ(read.motions.back().to.tip_mm, (Vec3{1, 0, 0}));
}

TEST(Post, RotaryTablesReachEveryPose) {
  for (const char* machine : {"xyzac-trt", "xyzbc-trt"}) {
    const Scene scene = scene_for(machine);
    for (const Post post : {Post::kLinuxcnc, Post::kFanuc, Post::kHaas, Post::kHeidenhain})
      for (std::uint64_t seed = 0; seed < 3; ++seed) {
        const Program program = random_program(seed, true, 6);
        const std::string text = text_of(program, scene, post);
        const Program read = read_back(scene, text, post);
        const auto is_at = [](const ToolPose& a, const ToolPose& b) {
          return off_mm(a, b) < 5.1e-4 && length(a.axis - b.axis) < 3e-5;
        };
        auto at = read.motions.begin();
        for (const ProgramMotion& motion : program.motions) {
          ASSERT_TRUE(at != read.motions.end() && is_at(at->from, motion.from)) << text;
          while (at != read.motions.end() && !is_at(at->to, motion.to)) ++at;
          ASSERT_TRUE(at != read.motions.end() && at->tool == motion.tool) << text;
          ++at;
        }
        EXPECT_TRUE(at == read.motions.end());
      }
  }
}

TEST(Post, FanucGetsToolVectors) {
  const Scene scene = scene_for("tool-vector");
  const Program program = random_program(3, true, 3);
  const std::string text = text_of(program, scene, Post::kFanuc);
  EXPECT_THAT(text, HasSubstr("G43.5 H"));
  const Program read = read_back(scene, text, Post::kFanuc);
  ASSERT_EQ(read.motions.size(), program.motions.size());
  for (std::size_t i = 0; i < read.motions.size(); ++i) {
    EXPECT_EQ(read.motions[i].to.tip_mm, program.motions[i].to.tip_mm);
    EXPECT_LT(length(read.motions[i].to.axis - program.motions[i].to.axis), 2e-6);
  }
}

// Tools of 50 and 80 mm: without G43 H the tip would be 50 and 80 mm deeper.
TEST(Post, TipDepthIsTheSameWithAToolTable) {
  ToolTable tools;
  tools[1].offset[2] = 50;
  tools[2].offset[2] = 80;
  for (const char* machine : {"xyz", "xyzac-trt"}) {
    const Scene scene = scene_for(machine);
    const Program program = random_program(5, false, 3);
    for (const Post post : {Post::kLinuxcnc, Post::kFanuc, Post::kHaas}) {
      const std::string text = text_of(program, scene, post);
      const Program read = read_back(scene, text, post, tools);
      ASSERT_EQ(read.motions.size(), program.motions.size()) << text;
      for (std::size_t i = 0; i < read.motions.size(); ++i)
        ASSERT_LE(off_mm(read.motions[i].to, program.motions[i].to), 1e-6) << i << "\n" << text;
    }
  }
}

constexpr const char* kSource =
    "(head)\nT1 M6\n(pocket)\nS12000 M3\nM8\nG0 X0 Y0\nG0 Z5\nG1 Z-2 F300\nM1\nG2 X10 I5\nM0\n"
    "G1 X20\nM9\nM5\nG53 G0 Z0\n(slot)\nT2 M6\nS800 M4\nM7\nG0 X0 Y9\nG0 Z5\nG1 Z-1\nS900\n"
    "G1 X9\nG0 Z5\nM5\nM2\n";

std::vector<std::string> shown(const std::vector<ProgramRemark>& remarks) {
  std::vector<std::string> lines;
  for (const auto& [motions, said] : remarks)
    lines.push_back(std::to_string(motions) + ": " + std::to_string(static_cast<int>(said.kind)) +
                    " " + std::to_string(said.rpm) + " " + said.text);
  return lines;
}

TEST(Post, SpindleCoolantStopsAndCommentsAreCarried) {
  const Scene scene = scene_for("xyz");
  const Program source = test::gcode(scene, kSource);
  ASSERT_EQ(source.remarks.size(), 12u);
  for (const Post post : {Post::kLinuxcnc, Post::kFanuc, Post::kHeidenhain}) {
    const std::string text = text_of(source, scene, post);
    const Program read = read_back(scene, text, post);
    // Klartext has one coolant, and its comments are not read.
    std::vector<ProgramRemark> expected;
    for (ProgramRemark remark : source.remarks) {
      using Kind = MachineRemark::Kind;
      const bool klartext = post == Post::kHeidenhain;
      if (klartext && remark.said.kind == Kind::kComment) continue;
      if (klartext && remark.said.kind == Kind::kMist) remark.said.kind = Kind::kFlood;
      if (post == Post::kFanuc)
        for (char& c : remark.said.text) c = static_cast<char>(std::toupper(c));
      if (remark.said.text.starts_with("pocket") || remark.said.text.starts_with("POCKET"))
        continue;  // issued before the first tool change, like a head
      expected.push_back(remark);
    }
    EXPECT_EQ(shown(read.remarks), shown(expected)) << text;
  }
}

TEST(Post, ToolsAreChangedWithTheSpindleStoppedAndTheToolAway) {
  const Scene scene = scene_for("xyz");
  const Program source = test::gcode(scene, kSource);
  EXPECT_THAT(text_of(source, scene, Post::kLinuxcnc),
              HasSubstr("G53 G0 Z0\nM9\nM5\n(slot)\nT2 M6\nS800 M4\nM7\nG0 X0 Y9\nG0 G43 H2 Z5\n"));
  EXPECT_THAT(text_of(source, scene, Post::kHaas),
              HasSubstr("G53 G0 Z0.\nM9\nM5\n(SLOT)\nT2 M6\nS800 M4\nM8\nG0 X0. Y9.\n"
                        "G0 G43 H2 Z5.\n"));
  EXPECT_THAT(text_of(source, scene, Post::kFanuc),
              HasSubstr("G91 G28 Z0.\nG90\nM9\nM5\n(SLOT)\nT2 M6\nS800 M4\nM7\n"));
  EXPECT_THAT(text_of(source, scene, Post::kGrbl),
              HasSubstr("G53 G0 Z0\nM9\nM5\n(slot)\nT2\n(insert T2)\nM0\nS800 M4\nM7\nG0 X0 Y9\n"
                        "G0 Z5\n"));
  const std::string klartext = text_of(source, scene, Post::kHeidenhain);
  std::string unnumbered;
  std::istringstream lines(klartext);
  for (std::string line; std::getline(lines, line);)
    unnumbered += line.substr(line.find(' ') + 1) + '\n';
  EXPECT_THAT(unnumbered, HasSubstr("L M140 MB MAX\nM9\nM5\n; slot\nTOOL CALL 2 Z S800\nM4\nM8\n"));
  EXPECT_THAT(unnumbered, HasSubstr("TOOL CALL S900\nL X+9\n"));
}

TEST(Post, TablesTurnWithTheToolAwayAndWithoutToolCenterControl) {
  const Scene scene = scene_for("xyzac-trt");
  Program program;
  program.motions.push_back({.tool = 1,
                             .from = admit_pose({{10, 0, -2}, {0, 0.6, 0.8}}),
                             .to = admit_pose({{20, 0, -2}, {0, 0.6, 0.8}}),
                             .duration_s = 1});
  program.motions.push_back({.tool = 1,
                             .from = admit_pose({{0, 0, -2}, {0, 0, 1}}),
                             .to = admit_pose({{0, 9, -2}, {0, 0, 1}}),
                             .duration_s = 1});
  EXPECT_THAT(text_of(program, scene, Post::kHaas),
              HasSubstr("G0 A36.87 C0.\nG0 X10. Y1.2\nG0 G234 H1 X10. Y0. Z-2.\nG1 X20. F600.\n"
                        "G49\nG53 G0 Z0.\nG0 A0. C0.\nG0 X0. Y0.\nG0 G234 H1 X0. Y0. Z-2.\n"));
  EXPECT_THAT(text_of(program, scene, Post::kFanuc),
              HasSubstr("G49\nG91 G28 Z0.\nG90\nG0 A0. C0.\nG0 X0. Y0.\nG0 G43.4 H1 X0."));
  EXPECT_THAT(text_of(program, scene, Post::kLinuxcnc),
              HasSubstr("M429\nG53 G0 Z0\nG0 A0 C0\nG0 X0 Y0\nM428\nG0 X0 Y0 Z-2\n"));
}

TEST(Post, UnsupportedMachinesAreRejected) {
  std::ostringstream out;
  const auto error = [&](const char* machine, Post post) {
    const auto made = make_program_writer({.post = post}, scene_for(machine), out);
    return made ? std::string() : made.error();
  };
  EXPECT_THAT(error("xyzac-trt", Post::kGrbl), HasSubstr("use a scene with the machine xyz"));
  EXPECT_THAT(error("tool-vector", Post::kHaas), HasSubstr("Haas cannot be written"));
  EXPECT_THAT(error("tool-vector", Post::kHeidenhain), HasSubstr("machine tool-vector"));
  EXPECT_EQ(error("xyzbc-trt", Post::kHaas), "");
}

TEST(Post, NamesMatchTheCommandLine) {
  EXPECT_EQ(post_names(), "linuxcnc, grbl, fanuc, haas, heidenhain");
  EXPECT_EQ(post_of("haas"), Post::kHaas);
  EXPECT_EQ(post_of("mach3"), std::nullopt);
}

// Joining motions keeps a remark at its position.
TEST(Post, MotionsAreNotJoinedAcrossARemark) {
  const Scene scene = scene_for("xyz");
  const Program source =
      test::gcode(scene, "T1 M6\nG0 X0 Y0\nG0 Z5\nG1 X1 F100\nG1 X2\nM8\nG1 X3\nG1 X4\nM2\n");
  std::ostringstream out;
  auto writer = make_program_writer({.tolerance_mm = 0.01}, scene, out);
  ASSERT_TRUE(write_program(source, **writer));
  EXPECT_THAT(out.str(), HasSubstr("G1 X2 F100\nM8\nX4\n"));
}

}  // namespace
}  // namespace kerf::post_test
