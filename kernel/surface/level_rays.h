// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/surface/crossing.h"

namespace kerf {

/// The crossings of horizontal lattice edges in a block with three fields. Rays along X and Y meet
/// those along Z in the samples of the lattice, so every horizontal edge is part of a ray and the
/// ends on it are exact.
class LevelRays {
 public:
  /// `solid` must have three fields.
  explicit LevelRays(const SolidSnapshot& solid);

  /// Returns the crossing of the edge from sample (i, j, k) to the next along X or Y. `leaves`
  /// states that the first sample is solid, as decided by the field along Z. Where the surface
  /// passes within the tolerance of a sample, the other fields may disagree, so an end of the right
  /// kind is accepted up to a quarter of the pitch beyond the edge. Returns nothing if there is no
  /// such end.
  std::optional<Crossing> find(std::int32_t i, std::int32_t j, std::int32_t k, bool along_x,
                               bool leaves) const;

 private:
  const DexelSnapshot& x_field_;
  const DexelSnapshot& y_field_;
};

}  // namespace kerf
