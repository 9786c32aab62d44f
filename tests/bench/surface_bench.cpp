// SPDX-License-Identifier: Apache-2.0
// Measures the speed of meshing and encoding on one core and the size of the result: the block of
// the standard job, untouched, carved in three axes and in five. Times are CPU seconds of this
// thread. `features` prints the mesh error of random carvings, everywhere and away from features
// below the pitch; `crossings` prints the number of triangles that cross each other; `export`
// prints the size of the whole surface of blocks up to 10 m with one cut. Usage:
// surface_bench [pitch_mm=0.25]; surface_bench features; surface_bench crossings; surface_bench
// export; surface_bench vertices [jobs=2000] [first seed=0]. `vertices` prints the distance of
// vertices from the true solid, and crossings, for every tool and ray model.

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <vector>

#include "kernel/surface/solid_surface.h"
#include "kernel/surface/tile_mesh.h"
#include "server/feed/mesh_glb.h"
#include "tests/bench/crossing_count.h"
#include "tests/bench/feature_error.h"
#include "tests/bench/vertex_error.h"
#include "tests/support/standard_job.h"

namespace {

using namespace kerf;

double cpu_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Prints the vertical distance of corners and centroids from the exact three-axis surface, away
/// from the ends of the rows.
void measure_error(const std::vector<TileMesh>& meshes, double pitch_mm) {
  double worst = 0, sum = 0;
  std::size_t count = 0;
  const auto add = [&](Vec3 p) {
    constexpr double kRowEndsMm = 10;
    const bool inside = p.x > kRowEndsMm && p.x < 100 - kRowEndsMm && p.y > kRowEndsMm &&
                        p.y < 100 - kRowEndsMm && p.z > 40;
    if (!inside) return;
    const double error = std::abs(p.z - test::standard_surface(p.y));
    worst = std::max(worst, error);
    sum += error * error;
    ++count;
  };
  for (const TileMesh& mesh : meshes) {
    for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
      Vec3 centroid;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto& q = mesh.positions_mm[mesh.indices[n + c]];
        const Vec3 p{double(q[0]), double(q[1]), double(q[2])};
        add(p);
        centroid = centroid + p * (1.0 / 3);
      }
      add(centroid);
    }
  }
  const double rms = std::sqrt(sum / static_cast<double>(count));
  std::printf("  error  max %.4f mm (%.3f pitch), rms %.4f mm\n", worst, worst / pitch_mm, rms);
}

std::vector<TileMesh> measure(const char* name, const SolidSnapshot& snapshot) {
  const DexelGrid& grid = snapshot.grid();
  const MeshQuantization quantization = mesh_quantization(grid);
  std::vector<TileMesh> meshes;
  std::size_t triangles = 0, bytes = 0;
  const double start = cpu_seconds();
  for (std::int32_t y = 0; y < grid.tiles_y(); ++y) {
    for (std::int32_t x = 0; x < grid.tiles_x(); ++x) {
      meshes.push_back(mesh_tile(snapshot, {x, y}));
      triangles += meshes.back().indices.size() / 3;
    }
  }
  const double meshed = cpu_seconds();
  std::vector<EncodedTile> encoded;
  for (const TileMesh& mesh : meshes)
    encoded.push_back(encode_tile(mesh, quantization, 1, TileCompression::kMeshopt));
  const double done = cpu_seconds();
  std::vector<const EncodedTile*> pointers;
  for (const EncodedTile& tile : encoded) {
    bytes += tile.bytes();
    pointers.push_back(&tile);
  }
  const double before_glb = cpu_seconds();
  const std::size_t glb_bytes = write_mesh_glb(pointers, quantization, 0, 1).size();
  const double glb_seconds = cpu_seconds() - before_glb;
  const auto tiles = static_cast<double>(meshes.size());
  std::printf("%-10s %6.0f tiles %9zu triangles (%5.0f/tile)\n", name, tiles, triangles,
              static_cast<double>(triangles) / tiles);
  std::printf("  mesh   %8.2f M triangles/s %8.0f tiles/s %7.0f us/tile\n",
              1e-6 * static_cast<double>(triangles) / (meshed - start), tiles / (meshed - start),
              1e6 * (meshed - start) / tiles);
  std::printf("  encode %8.0f tiles/s, %8.0f bytes/tile; GLB of all: %.0f bytes/tile in %.1f ms\n",
              tiles / (done - meshed), static_cast<double>(bytes) / tiles,
              static_cast<double>(glb_bytes) / tiles, 1e3 * glb_seconds);
  return meshes;
}

void measure(Rays rays, double pitch_mm) {
  SculptureSettings settings = test::standard_settings(pitch_mm, 0.01);
  settings.keep_normals = true;
  settings.rays = rays;
  std::printf("\n%s\n", to_string(rays));
  for (const bool five_axis : {false, true}) {
    auto sculpture = *Sculpture::create(settings);
    if (!five_axis) measure("untouched", sculpture.solid());
    sculpture.apply(DefineTool{1, *make_tool(BallShape{10, 50})}).value();
    const std::vector<ToolPose> path = test::standard_path(five_axis);
    for (std::size_t n = 1; n < path.size(); ++n) {
      sculpture.apply(MoveTool{1, path[n - 1], path[n], 0.01, false}).value();
    }
    const auto meshes = measure(five_axis ? "five axes" : "three axes", sculpture.solid());
    if (!five_axis) measure_error(meshes, pitch_mm);
  }
}

/// Carves 100 mm x 100 mm of blocks of increasing size and prints the cost of their surfaces.
void print_exports() {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const Vec3 size :
         {Vec3{200, 200, 100}, Vec3{1e3, 1e3, 100}, Vec3{1e4, 1e4, 100}, Vec3{1e4, 1e4, 1e4}}) {
      auto sculpture = *Sculpture::create(
          {.stock = BoxStock{size * -0.5, size * 0.5}, .rays = rays, .pitch_mm = 0.5});
      sculpture.apply(DefineTool{1, *make_tool(BallShape{10, 50})}).value();
      for (int n = 0; n <= 20; ++n) {
        const Vec3 from{-50, 5.0 * n - 50, 0.5 * size.z - 5};
        sculpture.apply(MoveTool{1, {from}, {from + Vec3{100, 0, 0}}, 1, false}).value();
      }
      const SolidSnapshot solid = sculpture.solid();
      const double start = cpu_seconds();
      SolidSurface surface(solid);
      std::size_t triangles = 0;
      for (TileMesh piece; surface.next(piece);) triangles += piece.indices.size() / 3;
      std::printf(
          "%-9s %5.0f x %5.0f x %5.0f mm: %7zu triangles, %4zu tiles, %4zu squares, %.0f ms\n",
          to_string(rays), size.x, size.y, size.z, triangles, surface.tiles(), surface.squares(),
          1e3 * (cpu_seconds() - start));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "features") {
    print_feature_errors();
    return 0;
  }
  if (what == "crossings") {
    print_crossings();
    return 0;
  }
  if (what == "export") {
    print_exports();
    return 0;
  }
  if (what == "vertices") {
    const auto number = [&](int n, int otherwise) {
      return static_cast<unsigned>(argc > n ? std::atoi(argv[n]) : otherwise);
    };
    print_vertex_errors(number(3, 0), number(2, 2000));
    return 0;
  }
  const double pitch_mm = argc > 1 ? std::atof(argv[1]) : 0.25;
  std::printf("block 100 x 100 x 50 mm, pitch %.3g mm, one core, CPU time\n", pitch_mm);
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) measure(rays, pitch_mm);
  return 0;
}
