// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kernel/surface/crossing.h"

namespace kerf {

/// Where in its cell a vertex may lie, in pitches from the cell's centre.
struct CellLimits {
  Vec3 low, high;
};

/// The point that stands for one sheet of the surface in a cell.
struct SheetPoint {
  Vec3 place;          ///< in pitches from the cell's centre, within the limits
  bool sharp = false;  ///< the sheet has a crease or a corner here
};

/// Chooses the point from the sheet's crossings (`point`s in pitches from the cell's centre, at
/// least one). Where the normals differ little it lies on the surface above the crossings' mean,
/// midway between their chords and their planes, exact up to the third order. Else it is where the
/// planes meet: the least squares of the distances from them (Ju et al. 2002), so that ridges and
/// corners are sharp. A plane square to an axis is kept to the bit. What would lie outside of the
/// limits is sought on their border.
SheetPoint place_sheet(std::span<const Crossing> crossings, const CellLimits& limits);

}  // namespace kerf
