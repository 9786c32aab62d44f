// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf {

/// A dexel: one solid element of a column, between two heights in quanta above the block's lowest
/// plane (DexelGrid::z_quantum_mm).
struct Dexel {
  std::int32_t bottom = 0, top = 0;  ///< bottom < top
  friend constexpr bool operator==(const Dexel&, const Dexel&) = default;
};

}  // namespace kerf
