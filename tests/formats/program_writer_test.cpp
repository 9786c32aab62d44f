// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_writer.h"

#include "kernel/math/rotation.h"
#include "server/formats/machine_kinematics.h"
#include "server/formats/pose_grid.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::program_writer_test {
namespace {

using test::scene_for;
using testing::HasSubstr;
using testing::Not;

using MakeWriter = std::unique_ptr<ProgramWriter> (*)(const Scene&, std::ostream&);

std::string text_of(const Program& program, const Scene& scene, MakeWriter make) {
  std::ostringstream out;
  const WriteResult written = write_program(program, *make(scene, out));
  EXPECT_TRUE(written.has_value()) << written.error();
  return out.str();
}

// Random strokes of two tools with jumps, rests, rapids and pure turns, all on the pose grid.
Program random_program(std::uint64_t seed, bool tilt) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto pose = [&] {
    const Vec3 axis = tilt ? Vec3{any(random), any(random), any(random) + 1.1} : Vec3{0, 0, 1};
    return admit_pose({Vec3{any(random), any(random), any(random)} * 60, axis});
  };
  Program program;
  ToolPose at = pose();
  ToolId tool = 1;
  for (int i = 0; i < 60; ++i) {
    const double chance = any(random);
    if (chance > 0.8) at = pose();
    if (chance < -0.8) tool = 3 - tool;
    ToolPose to = pose();
    if (any(random) > 0.7) to.tip_mm = at.tip_mm;
    if (any(random) > 0.7) to.axis = at.axis;
    if (any(random) > 0.7) to.tip_mm.z = at.tip_mm.z;
    program.motions.push_back({.tool = tool,
                               .from = at,
                               .to = to,
                               .duration_s = 0.001 + std::abs(any(random)),
                               .line = 0,
                               .rapid = to.tip_mm != at.tip_mm && any(random) > 0.5});
    at = to;
  }
  return program;
}

void expect_same_poses(const Program& written, const Program& read, const std::string& text) {
  ASSERT_EQ(read.motions.size(), written.motions.size()) << text;
  for (std::size_t i = 0; i < read.motions.size(); ++i) {
    const ProgramMotion& a = written.motions[i];
    const ProgramMotion& b = read.motions[i];
    ASSERT_EQ(a.from, b.from) << i << "\n" << text;
    ASSERT_EQ(a.to, b.to) << i << "\n" << text;
    ASSERT_EQ(a.tool, b.tool) << i << "\n" << text;
    ASSERT_EQ(a.rapid, b.rapid) << i << "\n" << text;
    ASSERT_NEAR(b.duration_s / a.duration_s, 1, a.rapid ? 1e9 : 1e-6) << i << "\n" << text;
  }
}

TEST(ProgramWriter, GcodeForXyzReadsBackToTheSameBits) {
  const Scene scene = scene_for("xyz");
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Program program = random_program(seed, false);
    const std::string text = text_of(program, scene, make_gcode_writer);
    expect_same_poses(program, test::gcode(scene, text), text);
  }
}

TEST(ProgramWriter, GcodeForToolVectorReadsBackToTheSameBits) {
  const Scene scene = scene_for("tool-vector");
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Program program = random_program(seed, true);
    const std::string text = text_of(program, scene, make_gcode_writer);
    expect_same_poses(program, test::gcode(scene, text), text);
  }
}

TEST(ProgramWriter, AptReadsBackToTheSameBits) {
  for (const char* machine : {"xyz", "tool-vector", "xyzac-trt", "xyzbc-trt"}) {
    const Scene scene = scene_for(machine);
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const Program program =
          random_program(seed, scene.machine.kinematics != MachineKinematics::kXyz);
      const std::string text = text_of(program, scene, make_apt_writer);
      expect_same_poses(program, test::read(scene, "p.apt", text), text);
    }
  }
}

TEST(ProgramWriter, WritingReadTextAgainGivesTheSameText) {
  const Scene scene = scene_for("tool-vector");
  for (const MakeWriter make : {make_gcode_writer, make_apt_writer}) {
    const std::string name = make == make_apt_writer ? "p.apt" : "p.ngc";
    const std::string once = text_of(random_program(7, true), scene, make);
    const std::string twice = text_of(test::read(scene, name, once), scene, make);
    EXPECT_EQ(twice, text_of(test::read(scene, name, twice), scene, make));
  }
}

TEST(ProgramWriter, RotaryMachinesFollowTheGreatCircle) {
  for (const char* machine : {"xyzac-trt", "xyzbc-trt"}) {
    const Scene scene = scene_for(machine, 0.01);
    const double length_mm = scene.tools.at(1).tool.length_mm;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      std::mt19937_64 random(seed);
      std::uniform_real_distribution<double> any(-1, 1);
      ProgramMotion motion{
          .tool = 1,
          .from = admit_pose({{0, 0, 0}, {any(random), any(random), any(random) + 1}}),
          .to = admit_pose({{10, 0, 0}, {any(random), any(random), any(random) + 1}}),
          .duration_s = 2};
      if (seed % 3 == 0) motion.from.axis = {0, 0, 1};
      if (seed % 5 == 0) motion.to.axis = {0, 0, 1};
      Program program{.motions = {motion}};
      const std::string text = text_of(program, scene, make_gcode_writer);
      const Program read = test::gcode(scene, text);
      ASSERT_FALSE(read.motions.empty());
      EXPECT_EQ(read.motions.front().from.tip_mm, motion.from.tip_mm);
      EXPECT_EQ(read.motions.back().to.tip_mm, motion.to.tip_mm);
      double duration = 0;
      for (const ProgramMotion& m : read.motions) {
        duration += m.duration_s;
        const double s = m.to.tip_mm.x / 10;
        const Vec3 truth = turned_axis(motion.from.axis, motion.to.axis, s);
        ASSERT_LE(length_mm * length(m.to.axis - truth), 0.0101) << machine << " seed " << seed;
      }
      EXPECT_NEAR(duration, 2, 1e-5);
      EXPECT_LT(length(read.motions.back().to.axis - motion.to.axis), 2e-8) << "seed " << seed;
    }
  }
}

TEST(ProgramWriter, RotaryAngleContinuesPastAFullTurn) {
  // Three turns on a cone: C increases to 1080 without jumping back by 360.
  const Scene scene = scene_for("xyzac-trt");
  Program program;
  const auto pose = [](int i) {
    const double c = i * std::numbers::pi / 18;
    return admit_pose({{0, 0, 0}, {std::sin(c) * 0.5, std::cos(c) * 0.5, 0.8}});
  };
  for (int i = 0; i < 108; ++i)
    program.motions.push_back({.tool = 1, .from = pose(i), .to = pose(i + 1), .duration_s = 0.1});
  const std::string text = text_of(program, scene, make_gcode_writer);
  EXPECT_THAT(text, HasSubstr("C1080"));
  EXPECT_THAT(text, HasSubstr("M428"));
}

TEST(ProgramWriter, TiltedToolIsRejectedForXyz) {
  std::ostringstream out;
  const Scene scene = scene_for("xyz");
  const auto writer = make_gcode_writer(scene, out);
  const WriteResult written =
      writer->add({.tool = 1, .from = {{0, 0, 0}, {0, 0, 1}}, .to = {{0, 0, 0}, {0, 1, 0}}});
  ASSERT_FALSE(written.has_value());
  EXPECT_THAT(written.error(), HasSubstr("tilted"));
}

TEST(ProgramWriter, FailedStreamIsReported) {
  std::ostringstream out;
  out.setstate(std::ios::badbit);
  const Scene scene = scene_for("xyz");
  EXPECT_FALSE(make_gcode_writer(scene, out)->finish().has_value());
  EXPECT_FALSE(make_apt_writer(scene, out)->finish().has_value());
}

TEST(ProgramWriter, SceneNameCannotInjectCode) {
  Scene scene = scene_for("xyz");
  scene.name = "a) G1 X5 (\nG1 X6\r\nGOTO/1,2,3";
  const Program program = random_program(1, false);
  const std::string text = text_of(program, scene, make_gcode_writer);
  expect_same_poses(program, test::gcode(scene, text), text);
  const std::string apt = text_of(program, scene, make_apt_writer);
  expect_same_poses(program, test::read(scene, "p.apt", apt), apt);
}

TEST(ProgramWriter, MotionsOfZeroDurationKeepTheirPoses) {
  Program program = random_program(3, true);
  for (ProgramMotion& motion : program.motions) motion.duration_s = 0;
  program.motions.insert(program.motions.begin(), program.motions.front());
  program.motions[0].to = program.motions[0].from;
  for (ProgramMotion& motion : program.motions) motion.rapid = false;
  const Scene scene = scene_for("tool-vector");
  for (const MakeWriter make : {make_gcode_writer, make_apt_writer}) {
    const std::string name = make == make_apt_writer ? "p.apt" : "p.ngc";
    const Program read = test::read(scene, name, text_of(program, scene, make));
    ASSERT_EQ(read.motions.size(), program.motions.size());
    for (std::size_t i = 0; i < read.motions.size(); ++i) {
      EXPECT_EQ(read.motions[i].from, program.motions[i].from);
      EXPECT_EQ(read.motions[i].to, program.motions[i].to);
    }
  }
}

TEST(ProgramWriter, EmptyProgramReadsBackEmpty) {
  const Scene scene = scene_for("xyzac-trt");
  EXPECT_TRUE(test::gcode(scene, text_of({}, scene, make_gcode_writer)).motions.empty());
  EXPECT_TRUE(test::read(scene, "p.apt", text_of({}, scene, make_apt_writer)).motions.empty());
}

}  // namespace
}  // namespace kerf::program_writer_test
