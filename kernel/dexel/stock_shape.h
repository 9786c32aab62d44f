// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include "kernel/math/vec3.h"

namespace kerf {

/// A box with sides parallel to the coordinate axes.
struct BoxStock {
  Vec3 min_mm, max_mm;
  friend bool operator==(const BoxStock&, const BoxStock&) = default;
};
/// An upright cylinder, its axis parallel to Z through (center_x, center_y).
struct CylinderStock {
  double center_x_mm, center_y_mm, radius_mm, min_z_mm, max_z_mm;
  friend bool operator==(const CylinderStock&, const CylinderStock&) = default;
};
/// The shape of a stock before it is first cut.
using StockShape = std::variant<BoxStock, CylinderStock>;

}  // namespace kerf
