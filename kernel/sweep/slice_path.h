// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sweep/turning_frame.h"

namespace kerf {

/// Maximum number of bisections of a part.
inline constexpr int kHalvingsMax = 16;

/// Parameters of the search for the outermost ends of a slice of the tool along a motion
/// (kernel/sweep/README.md, "The tight model").
struct SliceSearch {
  int parts = 1;           ///< parts of the motion; each is searched between its two stations
  int halvings = 0;        ///< max bisections of a part, for rays with a non-connected hit set
  bool checked = false;    ///< search once more for ends that the bend leaves in doubt
  double bend_mm = 0;      ///< κ: greatest bend of a fixed point's path relative to the slice
  double missed_mm = 0;    ///< greatest depth in the sweep of an end that is not found
  double search_mm = 0;    ///< distance off the surface at which the search for an end stops
  bool shows_disc = true;  ///< a disc of the slice is not hidden within its neighbors
};

/// The path of a slice, and the parameters of its search.
struct SlicePath {
  TurningFrame frame;
  SliceSearch search;
  double speed_max_mm;  ///< greatest speed of a point of the slice, per unit of share
  double lowest_mm;     ///< lower bound of the slice's heights, relative to the middle tip
};

}  // namespace kerf
