// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/dexel/dexel_grid.h"
#include "kernel/math/int_lanes.h"

namespace kerf {

/// Rounds heights (mm) to the nearest depths (quanta) within the grid. Every cut is rounded so
/// before it is compared with an end (kernel/dexel/README.md).
class ToDepth {
 public:
  KERF_INLINE explicit ToDepth(const DexelGrid& grid)
      : origin_mm_(grid.origin_mm.z),
        inverse_quantum_(1 / grid.z_quantum_mm),
        height_(double(grid.height_quanta)) {}

  KERF_INLINE IntLanes operator()(const Lanes& height_mm) const {
    const Lanes above = greater((height_mm - origin_mm_) * inverse_quantum_, Lanes(0));
    return to_int_lanes(lesser(above, height_) + 0.5);
  }

 private:
  Lanes origin_mm_, inverse_quantum_, height_;
};

}  // namespace kerf
