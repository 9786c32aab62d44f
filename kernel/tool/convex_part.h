// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kernel/piece/tool_piece.h"

namespace kerf {

/// A convex part of a tool, as large as possible: adjoining frusta and arcs from the bottom up,
/// whose outline is concave. It depends on the outline alone, not on its division into sections.
struct ConvexPart {
  std::vector<ToolPiece> pieces;  ///< no balls; each begins where the one below ends
  std::vector<double> ridges_mm;  ///< heights at which the outline has an edge
  bool covered = false;           ///< the part below covers the lower disc
  friend bool operator==(const ConvexPart&, const ConvexPart&) = default;
};

/// Returns the convex parts of a tool, given its pieces from the tip up: from the first piece on,
/// each part extends as far as the union remains convex within kHullAllowanceMm. A part encloses
/// its pieces, and exceeds them by at most that.
std::vector<ConvexPart> convex_parts(std::span<const ToolPiece> pieces);

Extent extent(const ConvexPart& part);

/// Returns the piece at a height of the axis. Where two pieces meet it is the upper one; beyond an
/// end, the piece at the end.
const ToolPiece& piece_at(const ConvexPart& part, double z_mm);

/// Returns the radius at a height of the axis, or kNoRadiusMm beyond the part.
double radius_at(const ConvexPart& part, double z_mm);

}  // namespace kerf
