// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/dexel/tile_index.h"
#include "kernel/math/ray_axis.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// The regular grid of a field's columns, in the field's own frame (RayAxis). Column (i, j) is the
/// ray along +Z through x = origin.x + (i + 1/2) pitch, y = origin.y + (j + 1/2) pitch. A depth d
/// is the height z = origin.z + d * z_quantum_mm.
struct DexelGrid {
  Vec3 origin_mm;           ///< minimum corner of the block
  double pitch_mm = 1;      ///< distance of neighboring rays
  double z_quantum_mm = 1;  ///< a power of two; block height / quantum < 2^30
  std::int32_t columns_x = 0, columns_y = 0;
  std::int32_t height_quanta = 0;  ///< the block's height
  RayAxis axis = RayAxis::kZ;      ///< world axis that the frame's Z points along
  friend bool operator==(const DexelGrid&, const DexelGrid&) = default;
  std::int32_t tiles_x() const { return (columns_x + kTileSide - 1) / kTileSide; }
  std::int32_t tiles_y() const { return (columns_y + kTileSide - 1) / kTileSide; }
  bool has(TileIndex tile) const {
    return tile.x >= 0 && tile.y >= 0 && tile.x < tiles_x() && tile.y < tiles_y();
  }
  double x_mm(std::int32_t i) const { return origin_mm.x + (i + 0.5) * pitch_mm; }
  double y_mm(std::int32_t j) const { return origin_mm.y + (j + 0.5) * pitch_mm; }
  double z_mm(std::int32_t depth) const { return origin_mm.z + depth * z_quantum_mm; }
  /// Returns the volume of one quantum of one column.
  double quantum_mm3() const { return z_quantum_mm * pitch_mm * pitch_mm; }
};

}  // namespace kerf
