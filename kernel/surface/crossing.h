#pragma once

#include "kernel/math/vec3.h"

namespace kerf {

/// Where the surface crosses an edge of the lattice, and how it looks there. Places are in pitches:
/// sample k of column (i, j) stands at (i, j, k).
struct Crossing {
  Vec3 point;
  Vec3 normal;         ///< unit, outward
  double weight = 1;   ///< how well the plane is known: 1, or little where it is a guess
  bool guess = false;  ///< the normal is one; another crossing of the same sheet knows better
};

}  // namespace kerf
