// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/surface/crossing.h"

namespace kerf {

/// The rays along X and Y of a block that has them: they meet its rays along Z in the samples of
/// the lattice, so the edges between these are pieces of rays, and the ends on them are exact.
class LevelRays {
 public:
  /// Of a solid with three fields.
  explicit LevelRays(const SolidSnapshot& solid);

  /// Where the surface crosses the edge from sample (i, j, k) to the next along X or Y; `leaves`:
  /// the first of them is solid. Whether a sample is solid the field along Z decides. The others
  /// may see it otherwise where the surface passes within the tolerance of it, so the nearest end
  /// of the right kind is taken up to a quarter of the pitch beyond the edge; nothing if there is
  /// none.
  std::optional<Crossing> find(std::int32_t i, std::int32_t j, std::int32_t k, bool along_x,
                               bool leaves) const;

 private:
  const DexelSnapshot& x_field_;
  const DexelSnapshot& y_field_;
};

}  // namespace kerf
