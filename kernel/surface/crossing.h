// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/vec3.h"

namespace kerf {

/// Where the surface crosses an edge of the lattice, and how it looks there. Places are in pitches:
/// sample k of column (i, j) stands at (i, j, k).
struct Crossing {
  Vec3 point;
  Vec3 normal;  ///< unit, outward
  /// 1; less where the normal is a guess, and another crossing of the same sheet knows better.
  double weight = 1;
  bool wall = false;  ///< of a wall that no ray meets: the place is known to half a pitch

  bool is_guess() const { return weight < 1; }
};

}  // namespace kerf
