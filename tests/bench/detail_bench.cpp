// SPDX-License-Identifier: Apache-2.0
// Measures the time, size and error of each level of detail on the five-axis standard job and on a
// block with thin grooves, and of the mixture of levels sent to viewers that see the whole block or
// a part of it. Errors are measured in distance, in shading (the difference of the unit normals)
// and in skin (original where the exact surface is cut, or the reverse). Times are CPU seconds of
// this thread. Usage: detail_bench [pitch_mm=0.25]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "server/feed/mesh_glb.h"
#include "server/feed/tile_detail.h"
#include "tests/support/drawn_error.h"
#include "tests/support/standard_job.h"

namespace {

using namespace kerf;
using Levels = std::function<int(TileIndex)>;
using Details = std::function<TileDetail(TileIndex)>;

double cpu_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

TileDetail detail_of(const DexelGrid& grid, TileIndex tile, const Levels& levels) {
  TileDetail detail{.level = static_cast<std::uint8_t>(levels(tile)), .side = {}};
  for (std::size_t n = 0; n < kSides.size(); ++n) {
    const TileIndex beside{tile.x + kSides[n].x, tile.y + kSides[n].y};
    const bool inside =
        beside.x >= 0 && beside.y >= 0 && beside.x < grid.tiles_x() && beside.y < grid.tiles_y();
    if (inside) {
      detail.side[n] = std::min(detail.level, static_cast<std::uint8_t>(levels(beside)));
    }
  }
  return detail;
}

std::vector<TileMesh> show(const char* name, const std::vector<TileMesh>& exact,
                           const DexelGrid& grid, const Details& details) {
  std::vector<TileMesh> meshes;
  const double start = cpu_seconds();
  for (const TileMesh& mesh : exact) {
    meshes.push_back(coarser_tile(mesh, grid, details(mesh.tile)));
  }
  const double seconds = cpu_seconds() - start;
  const MeshQuantization quantization = mesh_quantization(grid);
  std::vector<EncodedTile> encoded;
  std::size_t triangles = 0, bytes = 0;
  for (const TileMesh& mesh : meshes) {
    encoded.push_back(encode_tile(mesh, quantization, 1, TileCompression::kMeshopt));
    triangles += mesh.indices.size() / 3;
    bytes += encoded.back().bytes();
  }
  std::vector<const EncodedTile*> pointers;
  for (const EncodedTile& tile : encoded) pointers.push_back(&tile);
  const auto tiles = static_cast<double>(exact.size());
  std::printf("%-34s %9zu triangles (%6.0f/tile) %6.0f bytes/tile, GLB %7.3f MB, %5.0f us/tile\n",
              name, triangles, static_cast<double>(triangles) / tiles,
              static_cast<double>(bytes) / tiles,
              1e-6 * static_cast<double>(write_mesh_glb(pointers, quantization, 0, 1).size()),
              1e6 * seconds / tiles);
  return meshes;
}

void print_share(const char* name, std::vector<double>& off, const char* unit) {
  std::ranges::sort(off);
  std::printf("    %s off by: half %.4f, 99 of 100 %.3f, all %.3f%s\n", name, off[off.size() / 2],
              off[off.size() * 99 / 100], off.back(), unit);
}

void print_error(const std::vector<TileMesh>& exact, const std::vector<TileMesh>& coarse,
                 double pitch_mm) {
  test::DrawnError error = test::drawn_error(exact, coarse, pitch_mm, pitch_mm / 2);
  print_share("surface", error.off_pitches, " pitches");
  print_share("normals", error.turns, "");
  std::printf("    wrong skin: %.4f %%\n", 100 * error.wrong_skin);
}

/// Returns a camera aimed at the middle of the block from `distance_mm`, 52 degrees above the
/// horizontal, with a field of view of 30 degrees, an image height of `height_px` and an allowed
/// error of `error_px`.
Levels look_from(const DexelGrid& grid, double distance_mm, double height_px, double error_px) {
  const double steep = 52 * std::numbers::pi / 180;
  const Vec3 eye{50, 50 - distance_mm * std::cos(steep), 50 + distance_mm * std::sin(steep)};
  const double pixel_rad = 2 * std::tan(std::numbers::pi / 12) / height_px;
  const ViewerLook look{eye, error_px * pixel_rad};
  return [look, grid](TileIndex tile) { return detail_level(look, grid, tile, 0); };
}

/// The standard job.
Sculpture raster(double pitch_mm) {
  SculptureSettings settings = test::standard_settings(pitch_mm, 0.01);
  settings.keep_normals = true;
  auto sculpture = *Sculpture::create(settings);
  sculpture.apply(DefineTool{1, *make_tool(BallShape{10, 50})}).value();
  const std::vector<ToolPose> path = test::standard_path(true);
  for (std::size_t n = 1; n < path.size(); ++n) {
    sculpture.apply(MoveTool{1, path[n - 1], path[n], 0.01, false}).value();
  }
  return sculpture;
}

/// The same block with grooves of a ball of 2 mm, 0.4 mm deep, in all directions of its top, and a
/// ring of a flat tool.
Sculpture grooves(double pitch_mm) {
  SculptureSettings settings = test::standard_settings(pitch_mm, 0.01);
  settings.keep_normals = true;
  auto sculpture = *Sculpture::create(settings);
  sculpture.apply(DefineTool{1, *make_tool(BallShape{2, 50})}).value();
  sculpture.apply(DefineTool{2, *make_tool(FlatShape{6, 50})}).value();
  const Vec3 up{0, 0, 1};
  const auto on_circle = [](double radius_mm, double angle, double z) {
    return Vec3{50 + radius_mm * std::cos(angle), 50 + radius_mm * std::sin(angle), z};
  };
  constexpr int kGrooves = 18;
  for (int n = 0; n < kGrooves; ++n) {
    const double angle = (n + 0.13) * 2 * std::numbers::pi / kGrooves;
    sculpture.apply(MoveTool{1, {on_circle(8, angle, 49.6), up}, {on_circle(30, angle, 49.6), up}})
        .value();
  }
  constexpr int kSteps = 120;
  for (int n = 0; n < kSteps; ++n) {
    const double step = 2 * std::numbers::pi / kSteps;
    sculpture
        .apply(
            MoveTool{2, {on_circle(40, n * step, 48), up}, {on_circle(40, (n + 1) * step, 48), up}})
        .value();
  }
  return sculpture;
}

void measure(const char* name, const SolidSnapshot& solid) {
  const DexelGrid& grid = solid.grid();
  std::vector<TileMesh> exact;
  const double start = cpu_seconds();
  for (std::int32_t y = 0; y < grid.tiles_y(); ++y) {
    for (std::int32_t x = 0; x < grid.tiles_x(); ++x) exact.push_back(mesh_tile(solid, {x, y}));
  }
  std::printf("%s: block 100 x 100 x 50 mm, pitch %.3g mm, %zu tiles; meshing %.0f us/tile\n", name,
              grid.pitch_mm, exact.size(),
              1e6 * (cpu_seconds() - start) / static_cast<double>(exact.size()));
  const auto from = [&grid](Levels levels) -> Details {
    return [&grid, levels = std::move(levels)](TileIndex tile) {
      return detail_of(grid, tile, levels);
    };
  };
  for (std::uint8_t level = 0; level <= kDetailLevelMax; ++level) {
    const std::string title = "level " + std::to_string(level);
    const auto coarse =
        show(title.c_str(), exact, grid, from([level](TileIndex) { return level; }));
    if (level == 0) continue;
    print_error(exact, coarse, grid.pitch_mm);
    // Like tiles sent under a budget.
    show("    with exact borders", exact, grid,
         [level](TileIndex) { return TileDetail{.level = level, .side = {}}; });
  }
  show("whole block, 1000 px high", exact, grid, from(look_from(grid, 300, 1000, 0.5)));
  show("whole block on a phone, 800 px", exact, grid, from(look_from(grid, 480, 800, 1)));
  show("close to its middle, 1000 px high", exact, grid, from(look_from(grid, 60, 1000, 0.5)));
}

}  // namespace

int main(int argc, char** argv) {
  const double pitch_mm = argc > 1 ? std::atof(argv[1]) : 0.25;
  measure("five axes", raster(pitch_mm).solid());
  measure("grooves", grooves(pitch_mm).solid());
  return 0;
}
