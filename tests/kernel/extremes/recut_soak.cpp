// SPDX-License-Identifier: Apache-2.0
// Cuts one path repeatedly with every tool, in one field and in three, and fails if a bit of the
// state, the volume or a result changes. Usage: recut_soak [times=1000000]

#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "tests/kernel/extremes/carving.h"

namespace {

using namespace kerf;

/// Returns false as soon as anything changes.
bool stays_as_it_is(const test::NamedTool& tool, Rays rays, long times) {
  SculptureSettings settings = test::block(8, 4, 1.1, 0.02);
  settings.rays = rays;
  auto sculpture = Sculpture::create(settings).value();
  sculpture.apply(DefineTool{1, tool.tool}).value();
  const ToolPose path[] = {test::leaning({-1, 0.2, -2}, 0.2), test::leaning({1, 0.4, -2.5}, 0.2),
                           test::leaning({1, 0.5, -2.4}, 0.3, 1)};
  const auto cut = [&](long k) {
    const std::size_t leg = std::size_t(k % 2);
    return sculpture.apply(MoveTool{1, path[leg], path[leg + 1], 0.001}).value();
  };
  cut(0);
  cut(1);
  const std::uint64_t state = sculpture.state_hash();
  const double volume = sculpture.removed_volume_mm3();
  for (long k = 0; k < times; ++k) {
    const MotionResult r = cut(k);
    const bool same = r.removed_mm3 == 0 && r.changed_tiles.empty() && r.wrench == Wrench{} &&
                      sculpture.removed_volume_mm3() == volume;
    if (!same || (k % 10000 == 0 && sculpture.state_hash() != state)) {
      std::printf("%s, %s: cut %ld changed something\n", tool.name.c_str(), to_string(rays), k);
      return false;
    }
  }
  const bool same = sculpture.state_hash() == state;
  std::printf("%-12s %-9s %ld cuts: %s\n", tool.name.c_str(), to_string(rays), times,
              same ? "nothing changed" : "the state changed");
  return same;
}

}  // namespace

int main(int argc, char** argv) {
  const long times = argc > 1 ? std::atol(argv[1]) : 1000000;
  bool good = true;
  for (const test::NamedTool& tool : test::every_tool(0.4)) {
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      good = stays_as_it_is(tool, rays, times) && good;
    }
  }
  return good ? 0 : 1;
}
