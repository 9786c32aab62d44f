// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernel/tool/tool.h"

namespace kerf::test {

/// Returns the radius of a piece at a height, directly from its definition, or a negative value
/// beyond the piece. Independent of kernel/piece.
inline double radius_at(const ToolPiece& piece, double h) {
  if (const auto* b = std::get_if<BallPiece>(&piece)) {
    const double d = h - b->center_mm;
    return std::abs(d) > b->radius_mm ? -1 : std::sqrt(b->radius_mm * b->radius_mm - d * d);
  }
  if (const auto* a = std::get_if<ArcPiece>(&piece)) {
    if (h < a->z0_mm || h > a->z1_mm) return -1;
    const double d = h - a->center_z_mm;
    return a->center_r_mm + std::sqrt(std::max(0.0, a->radius_mm * a->radius_mm - d * d));
  }
  const auto& f = std::get<FrustumPiece>(piece);
  if (h < f.z0_mm || h > f.z1_mm) return -1;
  return f.r0_mm + (f.r1_mm - f.r0_mm) * (h - f.z0_mm) / (f.z1_mm - f.z0_mm);
}

/// Returns the radius of a body at a height: that of its widest piece there.
inline double radius_at(const std::vector<ToolPiece>& pieces, double h) {
  double r = -1;
  for (const ToolPiece& p : pieces) r = std::max(r, test::radius_at(p, h));
  return r;
}

/// Returns the volume of the body up to a height by the midpoint rule.
inline double volume(const std::vector<ToolPiece>& pieces, double top, int slices = 200000) {
  double sum = 0;
  for (int i = 0; i < slices; ++i) {
    const double r = std::max(0.0, radius_at(pieces, top * (i + 0.5) / slices));
    sum += r * r;
  }
  return sum * std::numbers::pi * top / slices;
}

}  // namespace kerf::test
