// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/sweep/piece_side.h"
#include "kernel/sweep/turning_frame.h"

namespace kerf {

/// Maximum number of bisections of a part.
inline constexpr int kHalvingsMax = 16;

/// Parameters of the search for the outermost ends of a slice of the tool along a motion
/// (kernel/sweep/README.md, "The tight model").
struct SliceSearch {
  int parts = 1;  ///< parts of the motion; each is searched between its two stations
  /// Maximum number of bisections of a part, for rays with a non-connected hit set.
  int halvings = 0;
  bool checked = false;     ///< the side may have several outermost ends along the motion
  double bend_mm = 0;       ///< κ: greatest bend of a fixed point's path along normals of the side
  double disc_bend_mm = 0;  ///< the same along normals of the discs
  double missed_mm = 0;     ///< greatest depth in the sweep of an end that is not found
  double top_mm = 0;        ///< top of the grid, above which no end matters
  double search_mm = 0;     ///< distance off the surface at which the search for an end stops
  bool shows_disc = true;   ///< a disc of the slice is not hidden within its neighbors
};

/// Facts about the rows of a block before a slice is evaluated; bit r: row r.
struct RowBits {
  unsigned ahead = 0;  ///< the slice at its last pose is all that it sweeps
  /// The disc through which rays may enter, or leave, the slice is hidden within a neighbor that is
  /// swept there too. An end on it belongs to the neighbor too, and needs no search.
  unsigned hides_entry = 0, hides_exit = 0;
};

/// A slice at one pose, for rays that cross its discs.
struct DiscPose {
  Vec3 center;  ///< the anchor
  Vec3 u;
  double inverse_uz;
  double speed;   ///< u·V of the anchor
  Vec3 by_place;  ///< u·V at the position p from the anchor: speed + by_place·p
  DiscPlanes discs;
};

/// The discs of an upright or leaning slice at its stations.
struct DiscPath {
  /// At all stations, or only at the last if there are many. Empty if the slice leans too much.
  std::vector<DiscPose> poses;
  double least_uz = 0;
  double anchor = 0;  ///< height of the side's anchor
};

/// The path of a slice, and the parameters of its search.
struct SlicePath {
  TurningFrame frame;
  SliceSearch search;
  double reach_mm;      ///< greatest distance of a point of the slice from the tip
  double speed_max_mm;  ///< greatest speed of a point of the slice, per unit of share
  double lowest_mm;     ///< lower bound of the slice's heights
  DiscPath discs;
  TurningFrame::Poses first, last;  ///< for all rays: the poses at the shares 0 and 1

  /// Returns the pose at a share, computed in `between` unless it is the first or the last one.
  KERF_INLINE const TurningFrame::Poses& pose(double share, TurningFrame::Poses& between) const {
    if (share == 0) return first;
    if (share == 1) return last;
    return between = frame.placed(Lanes(share));
  }
};

}  // namespace kerf
