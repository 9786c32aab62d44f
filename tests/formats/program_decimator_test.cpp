// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_decimator.h"

#include "server/formats/machine_kinematics.h"
#include "server/formats/pose_grid.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::program_decimator_test {
namespace {

using test::scene_for;
using testing::HasSubstr;
using testing::Not;

/// Stores the motions that it receives.
class Recorder final : public ProgramWriter {
 public:
  explicit Recorder(std::vector<ProgramMotion>& motions) : motions_(motions) {}
  void note(const std::string& /*line*/) override {}
  WriteResult add(const ProgramMotion& motion) override {
    motions_.push_back(motion);
    return {};
  }
  WriteResult remark(const MachineRemark& /*said*/) override { return {}; }
  WriteResult finish() override { return {}; }

 private:
  std::vector<ProgramMotion>& motions_;
};

std::vector<ProgramMotion> joined(const std::vector<ProgramMotion>& motions, const Scene& scene,
                                  double tolerance_mm) {
  std::vector<ProgramMotion> out;
  ProgramDecimator decimator(std::make_unique<Recorder>(out), scene, tolerance_mm);
  for (const ProgramMotion& motion : motions) EXPECT_TRUE(decimator.add(motion));
  EXPECT_TRUE(decimator.finish());
  return out;
}

/// Short motions like those of a haptic device: a path whose curvature and tilt change randomly.
std::vector<ProgramMotion> device_motions(std::uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<ProgramMotion> motions;
  Vec3 velocity{0.05, 0, 0}, turning, tip, axis{0, 0, 1};
  ToolPose at = admit_pose({tip, axis});
  for (int n = 0; n < count; ++n) {
    velocity = velocity + Vec3{any(random), any(random), any(random)} * 0.0005;
    tip = tip + velocity;
    turning = turning + Vec3{any(random), any(random), 0} * 2e-5;
    axis = normalized(axis + turning);
    const ToolPose to = admit_pose({tip, axis});
    motions.push_back({.tool = 1, .from = at, .to = to, .duration_s = 0.001});
    at = to;
  }
  return motions;
}

double reach_of(const Scene& scene) { return scene.tools.at(1).tool.length_mm; }

/// Distance of a pose to the nearest pose of a motion, at the tip or the tool's far end.
double distance_to(const ProgramMotion& motion, const ToolPose& pose, double reach_mm) {
  double nearest = 1e9;
  for (int n = 0; n <= 2000; ++n) {
    const double share = n / 2000.0;
    const Vec3 tip = motion.from.tip_mm + (motion.to.tip_mm - motion.from.tip_mm) * share;
    const Vec3 axis = turned_axis(motion.from.axis, motion.to.axis, share);
    const Vec3 far = tip + axis * reach_mm - pose.tip_mm - normalized(pose.axis) * reach_mm;
    nearest = std::min(nearest, std::max(length(tip - pose.tip_mm), length(far)));
  }
  return nearest;
}

TEST(ProgramDecimator, StaysWithinTheToleranceAndKeepsTheTime) {
  const Scene scene = scene_for("tool-vector");
  for (const double tolerance_mm : {0.1, 0.01}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const auto motions = device_motions(seed, 600);
      const auto out = joined(motions, scene, tolerance_mm);
      EXPECT_LT(out.size(), motions.size() / 2);
      EXPECT_EQ(out.front().from, motions.front().from);
      EXPECT_EQ(out.back().to, motions.back().to);
      double before_s = 0, after_s = 0;
      for (const auto& m : motions) before_s += m.duration_s;
      for (const auto& m : out) after_s += m.duration_s;
      EXPECT_NEAR(after_s, before_s, 1e-9);
      // Every joined motion ends at the end of an original one.
      std::size_t at = 0;
      for (const auto& m : motions) {
        EXPECT_LE(distance_to(out.at(at), m.to, reach_of(scene)), tolerance_mm + 1e-3);
        at += m.to == out[at].to ? 1 : 0;
      }
      EXPECT_EQ(at, out.size());
    }
  }
}

TEST(ProgramDecimator, JoinsStraightMotionsOnly) {
  const Scene scene = scene_for("xyz");
  const auto pose = [](double x, double y) { return ToolPose{{x, y, 0}, {0, 0, 1}}; };
  std::vector<ProgramMotion> motions;
  for (int n = 0; n < 50; ++n) {
    motions.push_back({.tool = 1, .from = pose(n, 0), .to = pose(n + 1, 0), .duration_s = 1});
  }
  EXPECT_EQ(joined(motions, scene, 1e-6).size(), 1U);
  // A corner, a reversal, a rest, a rapid, a tool change and a jump each start a new motion.
  motions = {{.tool = 1, .from = pose(0, 0), .to = pose(1, 0), .duration_s = 1},
             {.tool = 1, .from = pose(1, 0), .to = pose(1, 1), .duration_s = 1},
             {.tool = 1, .from = pose(1, 1), .to = pose(1, 0), .duration_s = 1},
             {.tool = 1, .from = pose(1, 0), .to = pose(1, 0), .duration_s = 1},
             {.tool = 1, .from = pose(1, 0), .to = pose(2, 0), .duration_s = 1, .rapid = true},
             {.tool = 1, .from = pose(2, 0), .to = pose(3, 0), .duration_s = 1},
             {.tool = 2, .from = pose(3, 0), .to = pose(4, 0), .duration_s = 1},
             {.tool = 2, .from = pose(5, 0), .to = pose(6, 0), .duration_s = 1}};
  EXPECT_EQ(joined(motions, scene, 0.01), motions);
}

TEST(ProgramDecimator, ToleranceIsStatedInTheHead) {
  const Scene scene = scene_for("xyz");
  for (const ProgramFormat format : {ProgramFormat::kGcode, ProgramFormat::kApt}) {
    std::ostringstream with, without;
    const ProgramStyle joined{.format = format, .tolerance_mm = 0.025};
    ASSERT_TRUE(make_program_writer(joined, scene, with).value()->finish());
    ASSERT_TRUE(make_program_writer({.format = format}, scene, without).value()->finish());
    EXPECT_THAT(with.str(), HasSubstr("strays more than 0.025 mm"));
    EXPECT_THAT(without.str(), Not(HasSubstr("strays")));
  }
}

TEST(GcodeWriter, UnwindsTheRotaryTableWithTheToolRetracted) {
  for (const char* kinematics : {"xyzac-trt", "xyzbc-trt"}) {
    const Scene scene = scene_for(kinematics);
    Program program;
    const auto pose = [](int n) {
      const double angle = n * std::numbers::pi / 8;
      return admit_pose({{10 * std::cos(angle), 10 * std::sin(angle), 0},
                         {0.5 * std::cos(angle), 0.5 * std::sin(angle), 0.8}});
    };
    for (int n = 0; n < 16 * 50; ++n) {
      program.motions.push_back({.tool = 1, .from = pose(n), .to = pose(n + 1), .duration_s = 0.1});
    }
    std::ostringstream out;
    ASSERT_TRUE(write_program(program, *make_gcode_writer(scene, out)));
    const std::string text = out.str();
    double greatest = 0;
    std::size_t retracts = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      retracts += line == "G53 G0 Z0" ? 1 : 0;
      const auto at = line.find(" C");
      if (at != line.npos && line.front() != '(') {
        greatest = std::max(greatest, std::abs(std::stod(line.substr(at + 2))));
      }
    }
    EXPECT_GT(greatest, 360 * 19);
    EXPECT_LT(greatest, 360 * 22);
    EXPECT_GE(retracts, 4U);  // at the start, twice in between, at the end
    // Read back, the program ends at the same pose.
    const Program again = test::gcode(scene, text);
    ASSERT_GE(again.motions.size(), program.motions.size());
    EXPECT_LT(length(again.motions.back().to.tip_mm - program.motions.back().to.tip_mm), 1e-6);
  }
}

}  // namespace
}  // namespace kerf::program_decimator_test
