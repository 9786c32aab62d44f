// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/vec3.h"

namespace kerf {

/// A crossing of the surface with an edge of the lattice: position and normal. Positions are in
/// pitches: sample k of column (i, j) is at (i, j, k).
struct Crossing {
  Vec3 point;
  Vec3 normal;  ///< unit, outward
  /// 1, or less if the normal is an estimate, so that other crossings of the sheet dominate.
  double weight = 1;
  bool wall = false;      ///< on a wall that no ray meets, with a position known to half a pitch
  bool original = false;  ///< on the surface of the untouched stock

  bool is_guess() const { return weight < 1; }
};

}  // namespace kerf
