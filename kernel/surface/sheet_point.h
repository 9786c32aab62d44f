// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kernel/surface/crossing.h"

namespace kerf {

/// The part of a cell that may contain a vertex, in pitches from the cell's center.
struct CellLimits {
  Vec3 low, high;
};

/// The vertex position of one sheet of the surface in a cell.
struct SheetPoint {
  Vec3 place;          ///< in pitches from the cell's center, within the limits
  bool sharp = false;  ///< the sheet has a crease or a corner here
};

/// Computes a sheet's vertex position from its crossings (at least one; `point`s in pitches from
/// the cell's center). If the normals differ little, the vertex is on the surface above the
/// crossings' mean, midway between their chords and their tangent planes, which is exact up to
/// third order. Otherwise it minimizes the sum of squared distances from the tangent planes (T. Ju
/// et al., Dual Contouring of Hermite Data, 2002), so ridges and corners are sharp. Planes
/// perpendicular to an axis are met to the bit. A minimum outside the limits is replaced by the one
/// on their boundary.
SheetPoint place_sheet(std::span<const Crossing> crossings, const CellLimits& limits);

}  // namespace kerf
