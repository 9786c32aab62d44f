// SPDX-License-Identifier: Apache-2.0
// Section 5: the two forms of output, a model (Fig. 15) and an NC program (Fig. 17).

#include "tests/paper/output_checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <sstream>
#include <utility>

#include "server/formats/model/mesh_reader.h"
#include "server/formats/model/mesh_source.h"
#include "server/formats/model/model_writer.h"
#include "server/formats/program_writer.h"
#include "server/formats/scene.h"
#include "tests/paper/check.h"
#include "tests/paper/examples.h"
#include "tests/support/content_of.h"
#include "tests/support/temporary_folder.h"

namespace kerf::paper {
namespace {

/// Volume in a closed mesh, mm³.
double volume_of(const TriangleMesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    six += dot(mesh.vertices_mm[a], cross(mesh.vertices_mm[b], mesh.vertices_mm[c]));
  }
  return six / 6;
}

/// Returns whether each edge has two triangles, which pass it in opposite directions.
bool is_closed(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> passes;
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t a = triangle[n], b = triangle[(n + 1) % 3];
      passes[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  return std::ranges::all_of(passes, [](const auto& edge) { return edge.second == 0; });
}

Finding the_bird_is_an_stl_model() {
  const TriangleMesh& mesh = *bird_stl();
  const double volume = carved_bird().snapshot().volume_mm3();
  const double off = std::abs(volume_of(mesh) / volume - 1);
  const bool closed = is_closed(mesh);
  return {closed && mesh.triangles.size() >= 80000 && off < 2e-3,
          text("%zu triangles, %s, volume within %.2f %% of the dexels'", mesh.triangles.size(),
               closed ? "closed" : "open", 100 * off)};
}

Finding the_brush_is_played_from_its_program() {
  Replay& replay = replayed_brush();
  const DexelSnapshot a = replay.by_hand.snapshot(), b = replay.from_nc.snapshot();
  double worst = 0;
  for (std::int32_t j = 0; j < a.grid().columns_y; ++j) {
    for (std::int32_t i = 0; i < a.grid().columns_x; ++i) {
      const double off = a.view(i, j).topmost.top - b.view(i, j).topmost.top;
      worst = std::max(worst, std::abs(off) * a.grid().z_quantum_mm);
    }
  }
  const double volume =
      std::abs(replay.from_nc.removed_volume_mm3() / replay.by_hand.removed_volume_mm3() - 1);
  return {
      replay.motions > 500 && worst < 1e-4 && volume < 1e-6,
      text("%zu lines in five axes for %zu motions; the block that they leave is the sculpted one "
           "within 1e-4 mm",
           replay.lines, replay.motions)};
}

}  // namespace

Sculpture& carved_bird() {
  static Sculpture block = carve(bird()).block;
  return block;
}

std::shared_ptr<const TriangleMesh> bird_stl() {
  static const auto kMesh = [] {
    const test::TemporaryFolder folder;
    SnapshotMesh surface(carved_bird().solid());
    write_model(folder / "bird.stl", surface, {}).value();
    const std::string bytes = test::content_of(folder / "bird.stl");
    return std::make_shared<const TriangleMesh>(
        read_mesh(MeshFileFormat::kStl, std::as_bytes(std::span(bytes))).value());
  }();
  return kMesh;
}

Replay& replayed_brush() {
  static Replay replay = [] {
    const Example one = brush();
    Scene scene{.settings = one.settings};
    scene.tools[1].shape = one.shape;
    scene.tools[1].tool = make_tool(one.shape).value();
    scene.machine.kinematics = MachineKinematics::kXyzacTrt;
    scene.machine.spindle_tool = 1;
    std::ostringstream out;
    auto writer = make_gcode_writer(scene, out);
    Carved by_hand = carve(one);
    for (const Step& step : by_hand.steps) {
      const double seconds = length(step.to.tip_mm - step.from.tip_mm) / one.speed_mm_per_s;
      writer->add({.tool = 1, .from = step.from, .to = step.to, .duration_s = seconds}).value();
    }
    writer->finish().value();
    const std::string nc = out.str();
    const Program program = parse_program("brush.ngc", nc, scene).value();
    Replay made{std::move(by_hand.block), block_of(one.settings, one.shape),
                std::size_t(std::ranges::count(nc, '\n')), program.motions.size()};
    for (const ProgramMotion& motion : program.motions) {
      made.from_nc.apply(MoveTool{motion.tool, motion.from, motion.to, motion.duration_s}).value();
    }
    return made;
  }();
  return replay;
}

std::vector<Check> output_checks() {
  return {{"TheBirdIsAnStlModel", the_bird_is_an_stl_model},
          {"TheBrushIsPlayedFromItsProgram", the_brush_is_played_from_its_program}};
}

}  // namespace kerf::paper
