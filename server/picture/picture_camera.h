// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/dexel/stock_shape.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// A camera that shows a whole box, with a vertical field of view of 30 degrees and Z upwards.
class PictureCamera {
 public:
  /// `towards_eye`: from the middle of the box, not parallel to Z.
  PictureCamera(const BoxStock& box, double aspect, Vec3 towards_eye);
  Vec3 eye_mm() const { return eye_mm_; }
  /// Returns the unit vector from the eye through a point of the picture. x and y run from -1 to 1,
  /// to the right and upwards.
  Vec3 towards(double x, double y) const;

 private:
  Vec3 eye_mm_, forward_, side_, up_;  ///< side_ and up_ reach to the edges of the picture
};

}  // namespace kerf
