// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sculpture.h"
#include "server/formats/program.h"
#include "server/formats/scene.h"
#include "tests/support/test.h"

namespace kerf::test {

/// Returns the volume that a program removes from its scene's stock, mm³.
inline double removed_mm3(const Scene& scene, const Program& program) {
  auto sculpture = Sculpture::create(scene.settings).value();
  for (const auto& [id, tool] : scene.tools)
    EXPECT_TRUE(sculpture.apply(DefineTool{id, tool.tool}).has_value());
  for (const ProgramMotion& motion : program.motions)
    EXPECT_TRUE(sculpture
                    .apply(MoveTool{.tool = motion.tool,
                                    .from = motion.from,
                                    .to = motion.to,
                                    .duration_s = motion.duration_s,
                                    .feel = false})
                    .has_value());
  return sculpture.removed_volume_mm3();
}

}  // namespace kerf::test
