// SPDX-License-Identifier: Apache-2.0
// verify_nc SCENE PROGRAM [PART]: carves a scene's stock with an NC program. Reports rapid motions
// through material, contacts of shank or holder, the removed volume and, given a mesh of the
// finished part, gouges into it. Exits with 1 if there are any faults.
#include <kerf/formats/model/indexed_mesh.h>
#include <kerf/formats/model/mesh_distance.h>
#include <kerf/formats/model/mesh_reader.h>
#include <kerf/formats/model/mesh_source.h>
#include <kerf/formats/program.h>
#include <kerf/formats/scene.h>
#include <kerf/kernel/sculpture.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

namespace {

std::string read(const char* path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

int fail(const std::string& reason) {
  std::fprintf(stderr, "verify_nc: %s\n", reason.c_str());
  return 2;
}

/// Depth of the deepest point of the carved surface below the surface of the part, mm.
double deepest_gouge_mm(kerf::Sculpture& block, const kerf::TriangleMesh& mesh) {
  kerf::IndexedMesh part{{}, {}, mesh.triangles};
  for (const kerf::Vec3& v : mesh.vertices_mm) {
    part.positions_mm.push_back({float(v.x), float(v.y), float(v.z)});
  }
  const kerf::MeshDistance distance(part);
  kerf::SnapshotMesh surface(block.solid());
  double deepest = 0;
  std::uint32_t near = 0;
  for (kerf::MeshPiece piece; surface.next(piece);) {
    for (const auto& [x, y, z] : piece.positions_mm) {
      const kerf::Vec3 at = surface.origin_mm() + kerf::Vec3{double(x), double(y), double(z)};
      deepest = std::min(deepest, distance.signed_distance_mm(at, near));
    }
  }
  return -deepest;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return fail("usage: verify_nc SCENE PROGRAM [PART]");
  const auto scene = kerf::load_scene(argv[1]);
  if (!scene) return fail(to_string(scene.error()));
  const auto program = kerf::parse_program(argv[2], read(argv[2]), *scene);
  if (!program) return fail(to_string(program.error()));
  auto block = kerf::Sculpture::create(scene->settings);
  if (!block) return fail(block.error().reason);
  for (const auto& [id, tool] : scene->tools) block->apply(kerf::DefineTool{id, tool.tool}).value();

  int faults = 0;
  for (const kerf::ProgramMotion& motion : program->motions) {
    const kerf::MoveTool move{motion.tool, motion.from, motion.to, motion.duration_s};
    const auto result = block->apply(move);
    if (!result) return fail(result.error().reason);
    const std::string place = place_of(*program, motion.file, motion.line);
    if (motion.rapid && result->removed_mm3 > 0.001) {
      std::printf("%s: rapid removes %.3f mm3\n", place.c_str(), result->removed_mm3);
      ++faults;
    }
    if (result->stock_contact_mm > 0) {
      std::printf("%s: shank or holder %.3f mm in the stock\n", place.c_str(),
                  result->stock_contact_mm);
      ++faults;
    }
  }
  std::printf("removed %.1f mm3 in %zu motions\n", block->removed_volume_mm3(),
              program->motions.size());

  if (argc > 3) {
    const std::string bytes = read(argv[3]);
    const auto format = kerf::mesh_file_format(argv[3]);
    if (!format) return fail(std::string(argv[3]) + " is not a " + kerf::kMeshFileNames + " file");
    const auto part = kerf::read_mesh(*format, std::as_bytes(std::span(bytes)));
    if (!part) return fail(std::string(argv[3]) + ": " + part.error().reason);
    const double gouge_mm = deepest_gouge_mm(*block, *part);
    std::printf("deepest gouge %.4f mm\n", gouge_mm);
    if (gouge_mm > scene->settings.tolerance_mm) ++faults;
  }
  return faults == 0 ? 0 : 1;
}
