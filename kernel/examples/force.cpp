// SPDX-License-Identifier: Apache-2.0
// force: prints the cutting force along a slot that gets deeper with every pass.
#include <kerf/kernel/sculpture.h>

#include <cstdio>

int main() {
  kerf::SculptureSettings settings;
  settings.stock = kerf::BoxStock{{0, 0, 0}, {60, 20, 20}};
  settings.force.specific_force_n_per_mm2 = 0.5;  // force per engaged area
  auto block = kerf::Sculpture::create(settings).value();
  block.apply(kerf::DefineTool{1, kerf::make_tool(kerf::FlatShape{8, 25}).value()}).value();

  kerf::ToolPose pose{{-5, 10, 18}};
  for (int pass = 0; pass < 10; ++pass) {
    const kerf::ToolPose next{{pose.tip_mm.x + 6, 10, pose.tip_mm.z - 0.5}};
    const auto result = block.apply(kerf::MoveTool{1, pose, next, 0.2}).value();
    const kerf::Vec3 f = result.wrench.force_n;
    std::printf("x %5.1f mm: force (%6.2f %6.2f %6.2f) N, removed %6.1f mm3\n", next.tip_mm.x, f.x,
                f.y, f.z, result.removed_mm3);
    pose = next;
  }
  return 0;
}
