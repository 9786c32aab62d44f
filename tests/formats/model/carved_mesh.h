// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/formats/model/indexed_mesh.h"
#include "tests/support/carvings.h"

namespace kerf::test {

/// A block of 16 x 16 x 8 mm with a dozen random cuts, at 0.4 mm.
inline SolidSnapshot carved_block(unsigned seed) {
  const BoxStock block{{-6, 4, 2}, {10, 20, 10}};
  Sculpture sculpture = make_sculpture(block, 0.4);
  RandomCarver carver(sculpture, block.min_mm, block.max_mm, seed);
  for (int n = 0; n < 12; ++n) carver.cut();
  return sculpture.solid();
}

/// Its exact surface.
inline IndexedMesh carved_mesh(unsigned seed) {
  SnapshotMesh mesh(carved_block(seed));
  return collect_mesh(mesh);
}

}  // namespace kerf::test
