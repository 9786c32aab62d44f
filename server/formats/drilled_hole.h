// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// A hole that a canned cycle of G-code drills along -Z: the tool traverses to the hole at its
/// current level, descends to R, feeds to the bottom and leaves at traverse speed. Lengths are in
/// mm.
struct DrilledHole {
  /// 81; 82 with a dwell at the bottom; with pecks, 73 breaks chips, 83 leaves the hole.
  int code = 81;
  double x_mm = 0, y_mm = 0;
  double r_mm = 0;       ///< level from which it feeds
  double bottom_mm = 0;  ///< < r_mm
  double clear_mm = 0;   ///< level of the tool afterwards: r_mm, or its level before
  double peck_mm = 0;    ///< > 0 with 73 and 83
  double dwell_s = 0;    ///< with 82
  double mm_per_min = 0;
};

}  // namespace kerf
