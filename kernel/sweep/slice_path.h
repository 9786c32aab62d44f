// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sweep/turning_frame.h"

namespace kerf {

/// Halvings that a part may need.
inline constexpr int kHalvingsMax = 16;

/// How the outermost ends of a slice of the tool are searched along a motion (kernel/README.md,
/// "The tight model").
struct SliceSearch {
  int parts = 1;         ///< of the motion, between whose stations the search goes
  int halvings = 0;      ///< of a part, for rays that the slice meets late, leaves or comes back to
  bool checked = false;  ///< ends that the bend leaves in doubt are looked for once more
  double bend_mm = 0;    ///< κ: greatest bend of a fixed point's way, seen from the slice
  double missed_mm = 0;  ///< how deep in the sweep an end may be that is not found
  double search_mm = 0;  ///< how near to an outermost end the search goes, off the surface
  bool shows_disc = true;  ///< a disc of the slice is not hidden within its neighbours
};

/// The way of a slice, and what its search needs to know of it.
struct SlicePath {
  TurningFrame frame;
  SliceSearch search;
  double speed_max_mm;  ///< fastest that a point of the slice moves, per unit of share
  double lowest_mm;     ///< that the slice comes, relative to the middle tip
};

}  // namespace kerf
