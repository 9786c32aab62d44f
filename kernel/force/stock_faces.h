// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/dexel/dexel_field.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// The faces of the stock inside a tool, from the ends of columns and from what their neighbors
/// lack. They do not turn with the tool: a push along the normal of the tool would, and a force
/// that turns with what it pushes does work over a cycle.
class StockFaces {
 public:
  /// Distances between neighboring samples of a field's columns, in columns.
  struct Steps {
    std::int32_t i, j;
  };

  /// Adds the faces at a stretch of column (i, j) inside the tool, between two heights in the
  /// field's frame. The column is a sample of a grid with these steps, and stands for a rectangle
  /// of it: the face towards the next sample counts at whichever of the columns between them it is.
  void add(const DexelField& field, std::int32_t i, std::int32_t j, Steps steps, double lo_mm,
           double hi_mm);
  /// Returns the mean of the faces' normals, out of the stock, by area and by the square of the
  /// cosine of their angle with `direction`, a unit vector. Faces that turn away do not count; zero
  /// if none does.
  Vec3 towards(Vec3 direction) const;

 private:
  std::vector<Vec3> areas_mm2_;  ///< along the normal out of the stock
  std::vector<Dexel> beside_;
};

}  // namespace kerf
