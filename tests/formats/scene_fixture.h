// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/formats/program.h"
#include "server/formats/scene.h"
#include "tests/support/test.h"

namespace kerf::test {

/// A scene with a block of 100 x 100 x 50 mm, a ball (1) and a flat end mill (2) of 10 mm.
inline Scene scene_for(const std::string& kinematics, double tolerance_mm = 0.01) {
  const std::string text =
      R"({"name": "test", "stock": {"shape": "box", "min_mm": [-50,-50,-50], "max_mm": [50,50,0]},
          "accuracy": {"tolerance_mm": )" +
      std::to_string(tolerance_mm) +
      R"(}, "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60},
                      {"id": 2, "shape": "flat", "diameter_mm": 10, "length_mm": 50}],
          "machine": {"kinematics": ")" +
      kinematics + R"("}})";
  auto scene = parse_scene(text, {});
  EXPECT_TRUE(scene.has_value()) << to_string(scene.error());
  return scene.value();
}

/// Reads a program that must be valid.
inline Program read(const Scene& scene, const std::string& name, const std::string& text) {
  auto program = parse_program(name, text, scene);
  EXPECT_TRUE(program.has_value()) << to_string(program.error()) << "\n" << text;
  return program ? *program : Program{};
}
inline Program gcode(const Scene& scene, const std::string& text) {
  return read(scene, "p.ngc", text);
}

/// Returns the ends of a program's motions, rounded to 0.001 mm.
inline std::vector<Vec3> rounded_ends(const Program& program) {
  const auto rounded = [](double v) { return std::round(v * 1000) / 1000 + 0; };
  std::vector<Vec3> tips;
  for (const ProgramMotion& motion : program.motions) {
    const Vec3 p = motion.to.tip_mm;
    tips.push_back({rounded(p.x), rounded(p.y), rounded(p.z)});
  }
  return tips;
}

/// Returns the error of a program that must be invalid.
inline ProgramError error_of(const Scene& scene, const std::string& name, const std::string& text) {
  auto program = parse_program(name, text, scene);
  EXPECT_FALSE(program.has_value()) << text;
  return program ? ProgramError{} : program.error();
}

}  // namespace kerf::test
