// SPDX-License-Identifier: Apache-2.0
// Programs, tables, scenes and meshes that people upload.
#include <string>

#include "kernel/dexel/mesh_stock.h"
#include "server/formats/gcode/parameter_file.h"
#include "server/formats/gcode/tool_table.h"
#include "server/formats/model/mesh_reader.h"
#include "server/formats/model/repair_mesh.h"
#include "server/formats/program.h"
#include "server/formats/program_survey.h"
#include "server/formats/scene.h"
#include "tests/fuzz/targets.h"

namespace kerf::fuzz {
namespace {

const Scene& scene() {
  static const Scene kMade =
      parse_scene(
          R"({"name": "fuzz", "stock": {"shape": "box", "min_mm": [-50,-50,-50], "max_mm": [50,50,0]},
              "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60},
                        {"id": 2, "shape": "flat", "diameter_mm": 10, "length_mm": 50}],
              "machine": {"kinematics": "xyzac-trt"}})",
          {})
          .value();
  return kMade;
}

/// A program that is read again step by step, as a session carves it, has the same motions.
void check_stream(const std::string& name, Bytes input, const GcodeEnvironment& environment,
                  const Program& program) {
  struct Nothing final : ProgramVisitor {
    void begin() override {}
    void visit(std::span<const ProgramMotion>) override {}
  } nothing;
  const auto read = read_program(name, text_of(input), scene(), environment, nothing);
  require(read.has_value(), "a program can be read again");
  MotionStream stream(read->open(), std::nullopt);
  std::size_t count = 0;
  for (bool more = true; more;) {
    const auto step = stream.read();
    require(step.has_value(), "and once more, step by step");
    more = *step;
    for (; stream.next() != nullptr; stream.pop(), ++count) {
      require(count < program.motions.size() && *stream.next() == program.motions[count],
              "with the same motions");
    }
  }
  require(count == program.motions.size(), "and all of them");
}

/// The motions of a program are finite, have positive time, and each starts where it claims.
void check_program(const std::string& name, Bytes input) {
  // A loop of a few bytes may read ten million lines.
  GcodeEnvironment environment{.lines_max = 20'000};
  const auto program = parse_program(name, text_of(input), scene(), environment);
  if (!program) {
    require(!to_string(program.error()).empty(), "an error says what is wrong");
    return;
  }
  for (const ProgramMotion& motion : program->motions) {
    require(motion.duration_s > 0 && motion.duration_s < 1e12, "a motion takes time");
    const Vec3 length = motion.to.tip_mm - motion.from.tip_mm;
    require(dot(length, length) < 1e18, "a motion is finite");
    require(scene().tools.contains(motion.tool), "a motion has a tool of the scene");
  }
  check_stream(name, input, environment, *program);
}

}  // namespace

void read_gcode(Bytes input) { check_program("fuzz.ngc", input); }

void read_apt(Bytes input) { check_program("fuzz.apt", input); }

void read_tables(Bytes input) {
  (void)read_tool_table("fuzz.tbl", std::string(text_of(input)));
  (void)read_parameter_file("fuzz.var", std::string(text_of(input)));
}

/// The canonical text of a scene is a scene.
void read_scene(Bytes input) {
  const auto scene = parse_scene(text_of(input), {});
  if (!scene) return;
  const std::string text = scene_json(*scene);
  const auto again = parse_scene(text, {});
  require(again.has_value(), "the canonical text can be read");
  require(scene_json(*again) == text, "and is canonical");
}

/// The first byte selects the format.
void read_mesh(Bytes input) {
  if (input.empty()) return;
  constexpr MeshFileFormat kFormats[] = {MeshFileFormat::kStl, MeshFileFormat::kPly,
                                         MeshFileFormat::kObj, MeshFileFormat::k3mf,
                                         MeshFileFormat::kGlb};
  const auto format = kFormats[std::to_integer<unsigned>(input[0]) % std::size(kFormats)];
  auto mesh = kerf::read_mesh(format, input.subspan(1), 100'000);
  if (!mesh) return;
  for (const auto& triangle : mesh->triangles) {
    for (const std::uint32_t corner : triangle) {
      require(corner < mesh->vertices_mm.size(), "the corners of a triangle exist");
    }
  }
  if (repair_mesh(*mesh)) require(mesh_stock_fault(*mesh).empty(), "a repaired mesh is closed");
}

}  // namespace kerf::fuzz
