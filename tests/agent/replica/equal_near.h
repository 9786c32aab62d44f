// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/replica/replica.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/solid_snapshot.h"
#include "kernel/tool/tool_bounds.h"
#include "tests/support/test.h"

namespace kerf::test {

/// Expects that a replica has the columns of the server's block, to the bit, in the tiles within
/// `margin_mm` of tool 1, upright with its tip at `tip`.
inline void expect_equal_near(const agent::Replica& replica, const SolidSnapshot& solid, Vec3 tip,
                              double margin_mm) {
  std::vector<Dexel> local, remote;
  for (const DexelSnapshot& field : solid.fields) {
    const DexelField* own = replica.block().field(field.grid().axis);
    const Bounds box = grown(tool_bounds(*replica.block().tool(1), {tip, {0, 0, 1}}), margin_mm);
    const TileRegion near = tiles_through(field.grid(), box.lo_mm, box.hi_mm);
    EXPECT_GT(near.count(), 0);
    near.all_of([&](TileIndex at) {
      const auto tile = own->fresh(at);
      for (int n = 0; n < kTileColumns; ++n) {
        tile->read(n, local);
        const auto column = field.column(at.x * kTileSide + n % kTileSide,
                                         at.y * kTileSide + n / kTileSide, remote);
        const bool equal = std::ranges::equal(local, column);
        EXPECT_TRUE(equal) << "column " << n << " of tile " << at.x << ' ' << at.y;
        if (!equal) return false;
      }
      return true;
    });
  }
}

}  // namespace kerf::test
