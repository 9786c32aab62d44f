// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/dexel/dexel_field.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// The faces of the stock inside a tool, derived from the ends of columns and from gaps in their
/// neighbors. They do not turn with the tool. A push along the normal of the tool would, and a
/// force that turns with the pushed body does work over a cycle.
class StockFaces {
 public:
  /// Distances between neighboring samples of a field's columns, in columns.
  struct Steps {
    std::int32_t i, j;
  };

  /// Adds the faces at a stretch of column (i, j) inside the tool, between two heights in the
  /// field's frame. The column is a sample of a grid with these steps and represents a rectangle of
  /// it. The face towards the next sample counts once, whichever of the columns between them it is
  /// at.
  void add(const DexelField& field, std::int32_t i, std::int32_t j, Steps steps, double lo_mm,
           double hi_mm);
  /// Returns the mean of the faces' normals, out of the stock, weighted by area and by the square
  /// of the cosine of their angle with the unit vector `direction`. Faces that turn away do not
  /// count. Zero if no face counts.
  Vec3 towards(Vec3 direction) const;

 private:
  std::vector<Vec3> areas_mm2_;  ///< along the normal out of the stock
  std::vector<Dexel> beside_;
};

}  // namespace kerf
