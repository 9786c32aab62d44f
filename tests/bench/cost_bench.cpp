// SPDX-License-Identifier: Apache-2.0
// Measures the cost of each element of a scene: CPU time and bytes per motion without and with it.
// The variants of a group are interleaved (A B C A B C …) and each is compared with the first of
// its round, which cancels other load on the machine. The medians over all rounds are printed.
// `prices` prints the costs of programs predicted from a sample, and the measured costs.
// Usage: cost_bench [turns=15] [pitch_mm=0.2]
//        cost_bench prices [SCENE PROGRAM]...

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "kernel/surface/tile_mesh.h"
#include "tests/bench/price_table.h"

namespace {

using namespace kerf;

constexpr double kBlockMm = 100, kHeightMm = 50, kDepthMm = 3;
// Viewers receive changes at 30 Hz; an agent sends samples at 1 kHz.
constexpr std::size_t kMotionsPerFrame = 33;

double cpu_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

enum class Viewer { kNone, kSnapshots, kMeshes };

struct Variant {
  std::string name;
  SculptureSettings settings;
  Tool tool;
  std::vector<ToolPose> path;
  bool feel = true;
  Viewer viewer = Viewer::kNone;
};

struct Cost {
  double us = 0;  ///< per motion
  double bytes = 0;
};

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Returns a small raster around `center`: rows of 1 mm moves, 3 mm apart, with the axis swinging
/// by up to 20 degrees, `kDepthMm` below the top.
std::vector<ToolPose> hand_path(Vec3 center_mm, double top_mm, bool swing) {
  std::vector<ToolPose> path;
  for (int row = 0; row <= 30; ++row) {
    for (int i = 0; i <= 90; ++i) {
      const double x = row % 2 == 0 ? i - 45 : 45 - i;
      const double lean = swing ? 20 * std::numbers::pi / 180 * std::sin(0.1 * i + row) : 0;
      path.push_back({{center_mm.x + x, center_mm.y + 3 * row - 45.03, top_mm - kDepthMm},
                      {std::sin(lean), 0, std::cos(lean)}});
    }
  }
  return path;
}

SculptureSettings block(double side_mm, double height_mm, double pitch_mm) {
  return SculptureSettings{.stock = BoxStock{{0, 0, 0}, {side_mm, side_mm, height_mm}},
                           .pitch_mm = pitch_mm,
                           .tolerance_mm = 0.005,
                           .keep_normals = false};
}

Cost run(const Variant& v) {
  auto sculpture = *Sculpture::create(v.settings);
  sculpture.apply(DefineTool{1, v.tool}).value();
  std::vector<TileIndex> changed;
  const double start = cpu_seconds();
  for (std::size_t n = 1; n < v.path.size(); ++n) {
    const auto result =
        sculpture.apply(MoveTool{1, v.path[n - 1], v.path[n], 0.001, v.feel}).value();
    if (v.viewer == Viewer::kNone) continue;
    changed.insert(changed.end(), result.changed_tiles.begin(), result.changed_tiles.end());
    if (n % kMotionsPerFrame != 0) continue;
    const SolidSnapshot snapshot = sculpture.solid();
    std::ranges::sort(changed);
    changed.erase(std::ranges::unique(changed).begin(), changed.end());
    if (v.viewer == Viewer::kMeshes)
      for (const TileIndex tile : tiles_to_remesh(snapshot.grid(), changed))
        mesh_tile(snapshot, tile);
    changed.clear();
  }
  const double seconds = cpu_seconds() - start;
  const auto motions = double(v.path.size() - 1);
  return {1e6 * seconds / motions, double(sculpture.memory_bytes())};
}

void compare(const char* title, const std::vector<Variant>& variants, int turns) {
  std::printf("\n%s\n  %-44s %10s %8s %12s\n", title, "", "us/motion", "ratio", "bytes");
  std::vector<std::vector<double>> us(variants.size()), ratio(variants.size());
  std::vector<double> bytes(variants.size());
  for (int turn = 0; turn < turns; ++turn) {
    for (std::size_t i = 0; i < variants.size(); ++i) {
      const Cost cost = run(variants[i]);
      us[i].push_back(cost.us);
      ratio[i].push_back(cost.us / us[0].back());
      bytes[i] = cost.bytes;
    }
  }
  for (std::size_t i = 0; i < variants.size(); ++i) {
    std::printf("  %-44s %10.2f %8.3f %12.0f\n", variants[i].name.c_str(), median(us[i]),
                median(ratio[i]), bytes[i]);
  }
  std::fflush(stdout);
}

Obstacle box_obstacle(Vec3 low, Vec3 high) { return {BoxObstacle{low, high}, 1}; }

/// Returns a wall that the tool's holder passes at a distance of 2 mm, or one that is 5 m away.
std::vector<Obstacle> walls(int count, double x_mm) {
  std::vector<Obstacle> obstacles;
  for (int n = 0; n < count; ++n) {
    const double x = x_mm + 3 * n;
    obstacles.push_back(box_obstacle({x, -50, 0}, {x + 2, 150, 300}));
  }
  return obstacles;
}

/// Returns a ball of about this many triangles that the tool's holder passes at a distance of 2 mm.
std::vector<Obstacle> meshed_ball(int triangles) {
  constexpr double kRadiusMm = 100;
  const Vec3 center{103 + kRadiusMm, 50, 60};
  const int rings = int(std::sqrt(triangles / 4));
  const auto at = [&](int ring, int step) {
    const double low = std::numbers::pi * ring / rings, turn = std::numbers::pi * step / rings;
    return center + kRadiusMm * Vec3{std::sin(low) * std::cos(turn), std::sin(low) * std::sin(turn),
                                     -std::cos(low)};
  };
  MeshObstacle mesh;
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < 2 * rings; ++s) {
      mesh.triangles.push_back({at(r, s), at(r, s + 1), at(r + 1, s + 1)});
      mesh.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r + 1, s)});
    }
  }
  return {{std::move(mesh), 1}};
}

void measure(int turns, double pitch_mm) {
  const Tool ball = *make_tool(BallShape{10, 30});
  const auto path = hand_path({50, 50, 0}, kHeightMm, true);
  const Variant plain{"", block(kBlockMm, kHeightMm, pitch_mm), ball, path};
  const auto variant = [&plain](std::string name, const std::function<void(Variant&)>& change) {
    Variant made = plain;
    made.name = std::move(name);
    change(made);
    return made;
  };
  const auto nothing = [](Variant&) {};
  const auto watched = [](Viewer viewer) {
    return [viewer](Variant& v) {
      v.settings.keep_normals = true;
      v.viewer = viewer;
    };
  };
  const auto with_walls = [](int count, double x_mm) {
    return [=](Variant& v) { v.settings.obstacles = walls(count, x_mm); };
  };
  compare("identical scenes: noise of this run",
          {variant("once", nothing), variant("again", nothing)}, turns);
  compare("obstacles",
          {variant("none", nothing), variant("1, 5 m away", with_walls(1, 5000)),
           variant("20, 5 m away", with_walls(20, 5000)),
           variant("1, beside the tool's path", with_walls(1, 103)),
           variant("20, beside the tool's path", with_walls(20, 103))},
          turns);
  const auto with_mesh = [](int triangles) {
    return [=](Variant& v) { v.settings.obstacles = meshed_ball(triangles); };
  };
  compare("meshes as obstacles beside the tool's path",
          {variant("none", nothing), variant("1,000 triangles", with_mesh(1000)),
           variant("20,000 triangles", with_mesh(20'000)),
           variant("200,000 triangles", with_mesh(200'000))},
          turns);
  const ToolBody body{Shank{8, 40}, std::vector<HolderSection>{{30, 40, 20}, {40, 40, 60}}};
  const Tool whole = *make_tool(BallShape{10, 30}, body);
  const auto with_body = [&](int count, double x_mm) {
    return [&, count, x_mm](Variant& v) {
      v.tool = whole;
      if (count > 0) v.settings.obstacles = walls(count, x_mm);
    };
  };
  compare("shank and holder (two sections)",
          {variant("none", nothing), variant("present, no obstacle", with_body(0, 0)),
           variant("present, obstacle 5 m away", with_body(1, 5000)),
           variant("present, obstacle beside the path", with_body(1, 103))},
          turns);
  compare("forces",
          {variant("no force computed", [](Variant& v) { v.feel = false; }),
           variant("specific energy", nothing),
           variant("removal rate",
                   [](Variant& v) { v.settings.force.law = ForceLaw::kDexelRemovalRate; })},
          turns);
  compare("fields of rays",
          {variant("dexel", nothing),
           variant("tri-dexel", [](Variant& v) { v.settings.rays = Rays::kTriDexel; })},
          turns);
  compare("surface (30 frames a second at 1000 motions)",
          {variant("no viewer", nothing),
           variant("normals kept", [](Variant& v) { v.settings.keep_normals = true; }),
           variant("normals and snapshots", watched(Viewer::kSnapshots)),
           variant("normals, snapshots and meshes", watched(Viewer::kMeshes))},
          turns);
}

void measure_blocks(int turns) {
  constexpr double kPitchMm = 0.25;  // a block of 10 m has fewer than 2^32 columns
  const Tool ball = *make_tool(BallShape{10, 30});
  std::vector<Variant> variants;
  for (const double side : {100.0, 1000.0, 10000.0}) {
    const double middle = side / 2;
    for (const double height : {kHeightMm, side}) {
      if (height != kHeightMm && side == 100.0) continue;
      char name[64];
      std::snprintf(name, sizeof name, "%.3g x %.3g x %.3g m", side / 1000, side / 1000,
                    height / 1000);
      variants.push_back({name, block(side, height, kPitchMm), ball,
                          hand_path({middle, middle, 0}, height, true)});
    }
  }
  // Most of the raster is outside this small block.
  variants.push_back({"0.01 x 0.01 x 0.01 m (mostly air moves)", block(10, 10, kPitchMm), ball,
                      hand_path({5, 5, 0}, 10, true)});
  compare("untouched stock around a small carved area, pitch 0.25 mm", variants, turns);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "prices")
    return bench::print_price_table({argv + 2, argv + argc}) ? 0 : 1;
  const int turns = argc > 1 ? std::max(1, std::atoi(argv[1])) : 15;
  const double pitch_mm = argc > 2 ? std::atof(argv[2]) : 0.2;
  std::printf("ball 10 mm, %.0f mm deep, moves of 1 mm, axis swinging 20 degrees, pitch %.3g mm\n",
              kDepthMm, pitch_mm);
  std::printf("median of %d turns, CPU time of one core\n", turns);
  measure(turns, pitch_mm);
  measure_blocks(turns);
  return 0;
}
