// SPDX-License-Identifier: Apache-2.0
// Runs one job for every tool, ray model, motion model and force law, and prints one line for each
// with the hashes of the state, of all results (forces, volumes, tiles) and of the mesh. Two builds
// of the kernel that print the same bytes agree to the last bit. The jobs do not depend on the
// machine: poses are computed from integers by + − × ÷ √ alone. Usage: state_hashes [threads=1
// [every=1]]. The output does not depend on the number of threads. With `every` N, only each N-th
// job is run.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "kernel/math/hash.h"
#include "kernel/sculpture.h"
#include "kernel/surface/tile_mesh.h"
#include "tests/determinism/job_workers.h"

namespace {

using namespace kerf;

struct NamedTool {
  std::string name;
  Tool tool;
};

std::vector<NamedTool> tools() {
  return {{"ball", *make_tool(BallShape{6, 30})},
          {"flat", *make_tool(FlatShape{6, 30})},
          {"taper", *make_tool(TaperShape{3, 12, 30})},
          {"taper_ball", *make_tool(TaperShape{4, 8, 30, TaperTip::kBall})},
          {"cone_end", *make_tool(ConeEndShape{8, 90, 30})},
          {"bull_nose", *make_tool(BullNoseShape{6, 1, 30})},
          {"apt", *make_tool(AptShape{10, 1.5, 3.630717035815369, 2.0250053615596113, 8, 6, 25})},
          {"lollipop", *make_tool(ProfileShape{
                           {ProfilePoint{0, 0}, ProfileArc{{1, 5.828}, 3}, ProfilePoint{1, 30}}})}};
}

/// Knuth's 64-bit linear congruential generator: the same numbers on every platform, unlike the
/// distributions of <random>.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed) {}
  /// Returns a number uniform in [lo, hi), lo plus a multiple of (hi − lo) / 2^20.
  double in(double lo, double hi) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return lo + (hi - lo) * (double(state_ >> 44) / 1048576);
  }
  Vec3 vec(double lo, double hi) {
    const double x = in(lo, hi), y = in(lo, hi), z = in(lo, hi);
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

/// Returns a random path of short and long moves whose axis is constant, turns slowly or swings
/// far.
std::vector<ToolPose> path(std::uint64_t seed, int moves) {
  Numbers numbers(seed);
  std::vector<ToolPose> poses{{{0, 0, -1}, {0, 0, 1}}};
  for (int i = 0; i < moves; ++i) {
    const ToolPose& last = poses.back();
    const int what = i % 4;
    const double reach = what == 3 ? 9 : 1;
    const Vec3 tip = last.tip_mm + numbers.vec(-reach, reach);
    const Vec3 lean = numbers.vec(-1, 1) * (what == 0 ? 0.0 : what == 1 ? 0.05 : 0.7);
    const auto within = [](double v, double lo, double hi) {
      return v < lo ? lo : v > hi ? hi : v;
    };
    const Vec3 axis = what == 0 ? last.axis : normalized(Vec3{0, 0, 1} + lean);
    poses.push_back({{within(tip.x, -11, 11), within(tip.y, -11, 11), within(tip.z, -7, 1)}, axis});
  }
  return poses;
}

void add(Hash& hash, double value) { hash.add(std::bit_cast<std::uint64_t>(value)); }
void add(Hash& hash, Vec3 v) {
  add(hash, v.x);
  add(hash, v.y);
  add(hash, v.z);
}

void add(Hash& hash, const MotionResult& result) {
  hash.add(static_cast<std::uint64_t>(result.kind));
  for (const Wrench& w : {result.wrench, result.collision}) {
    add(hash, w.force_n);
    add(hash, w.torque_nmm);
  }
  add(hash, result.cutting.engaged_area_mm2);
  add(hash, result.cutting.direction);
  add(hash, result.cutting.center_mm);
  add(hash, result.removed_mm3);
  add(hash, result.imprint_mm3);
  hash.add(result.sub_motions);
  for (const TileIndex tile : result.changed_tiles) {
    hash.add(static_cast<std::uint64_t>(tile.x) << 32 | static_cast<std::uint32_t>(tile.y));
  }
}

std::uint64_t mesh_hash(const SolidSnapshot& snapshot) {
  Hash hash;
  const DexelGrid& grid = snapshot.grid();
  for (std::int32_t y = 0; y < grid.tiles_y(); ++y) {
    for (std::int32_t x = 0; x < grid.tiles_x(); ++x) {
      const TileMesh mesh = mesh_tile(snapshot, {x, y});
      for (const auto* vectors : {&mesh.positions_mm, &mesh.normals}) {
        for (const auto& v : *vectors) {
          for (const float f : v) hash.add(std::bit_cast<std::uint32_t>(f));
        }
      }
      for (const std::uint32_t index : mesh.indices) hash.add(index);
    }
  }
  return hash.value();
}

/// Returns moves across the whole block, enough work for several threads. Every other move turns.
std::vector<ToolPose> long_path(std::uint64_t seed, int moves) {
  Numbers numbers(seed);
  std::vector<ToolPose> poses{{{-62, 0, -1}, {0, 0, 1}}};
  for (int i = 0; i < moves; ++i) {
    const double x = i % 2 == 0 ? 62 : -62;
    const double y = numbers.in(-55, 55), z = numbers.in(-6, -1);
    const Vec3 axis =
        i % 2 == 0 ? poses.back().axis : normalized(Vec3{0, 0, 1} + numbers.vec(-1, 1) * 0.1);
    poses.push_back({{x, y, z}, axis});
  }
  return poses;
}

struct Jobs {
  test::JobWorkers workers;
  int every = 1;
  int seen = 0;
};

void run(const std::string& name, const SculptureSettings& settings, const Tool& tool,
         const std::vector<ToolPose>& poses, Jobs& jobs) {
  if (jobs.seen++ % jobs.every != 0) return;
  auto sculpture = *Sculpture::create(settings);
  sculpture.apply(DefineTool{1, tool}).value();
  Hash results;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const auto moved = sculpture.apply(MoveTool{1, poses[i - 1], poses[i], 0.01}, jobs.workers);
    if (moved) {
      add(results, *moved);
    } else {
      results.add(static_cast<std::uint64_t>(moved.error().code));
    }
  }
  const auto hex = [](std::uint64_t v) { return static_cast<unsigned long long>(v); };
  std::printf("%-46s state %016llx results %016llx mesh %016llx\n", name.c_str(),
              hex(sculpture.state_hash()), hex(results.value()), hex(mesh_hash(sculpture.solid())));
}

/// Returns overlapping octahedra at random positions.
std::shared_ptr<const TriangleMesh> mesh_stock() {
  auto mesh = std::make_shared<TriangleMesh>();
  Numbers numbers(77);
  for (std::uint32_t n = 0; n < 12; ++n) {
    const Vec3 c = numbers.vec(-8, 8);
    const double r = numbers.in(3, 7);
    for (const Vec3& d : {Vec3{r, 0, 0}, Vec3{-r, 0.1, 0}, Vec3{0, r, 0.2}, Vec3{0, -r, 0},
                          Vec3{0.3, 0, r}, Vec3{0, 0, -r}}) {
      mesh->vertices_mm.push_back(c + d);
    }
    for (const auto& [a, b, e] : {std::array<std::uint32_t, 3>{0, 2, 4},
                                  {2, 1, 4},
                                  {1, 3, 4},
                                  {3, 0, 4},
                                  {2, 0, 5},
                                  {1, 2, 5},
                                  {3, 1, 5},
                                  {0, 3, 5}}) {
      mesh->triangles.push_back({6 * n + a, 6 * n + b, 6 * n + e});
    }
  }
  return mesh;
}

}  // namespace

int main(int argc, char** argv) {
  Jobs jobs{.workers = test::JobWorkers(argc > 1 ? std::atoi(argv[1]) : 1),
            .every = argc > 2 ? std::max(1, std::atoi(argv[2])) : 1};
  SculptureSettings box{
      .stock = BoxStock{{-12, -12, -8}, {12, 12, 0}}, .pitch_mm = 0.4, .force = {.pivot_mm = 30}};
  SculptureSettings round = box;
  round.stock = CylinderStock{1, -1, 10, -8, 0};
  round.force.law = ForceLaw::kDexelRemovalRate;
  round.obstacles = {{SphereObstacle{{5, 5, 2}, 3}, 2}, {BoxObstacle{{-9, -9, -9}, {-6, 9, 1}}, 1}};
  std::uint64_t seed = 1;
  for (const NamedTool& tool : tools()) {
    for (const double tolerance : {0.01, 0.001}) {
      for (SculptureSettings settings : {box, round}) {
        settings.tolerance_mm = tolerance;
        const std::string name = tool.name + (settings.obstacles.empty() ? " box" : " cylinder") +
                                 " tolerance " + std::to_string(tolerance);
        run(name, settings, tool.tool, path(++seed, 8), jobs);
        if (tolerance < 0.01) continue;
        settings.rays = Rays::kTriDexel;
        settings.pitch_mm = 0.6;
        run(name + " tri-dexel", settings, tool.tool, path(++seed, 6), jobs);
        settings.rays = Rays::kDexel;
        settings.tolerance_mm = 0.03;
        settings.motion = MotionModel::kPaper;
        run(name + " paper", settings, tool.tool, path(++seed, 1), jobs);
      }
    }
  }
  SculptureSettings meshed = box;
  meshed.stock_mesh = mesh_stock();
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    meshed.rays = rays;
    run(std::string("mesh ") + to_string(rays), meshed, tools().front().tool, path(++seed, 4),
        jobs);
  }
  SculptureSettings wide = box;
  wide.stock = BoxStock{{-60, -60, -8}, {60, 60, 0}};
  for (const NamedTool& tool : tools()) {
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      wide.rays = rays;
      run(tool.name + " long " + to_string(rays), wide, tool.tool, long_path(++seed, 3), jobs);
    }
  }
  // Fails if several threads were available but never used, because the comparison would prove
  // nothing.
  return jobs.workers.count() > 1 && jobs.workers.runs() == 0 ? 1 : 0;
}
