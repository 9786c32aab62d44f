// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "server/formats/program.h"

namespace kerf {

/// Where the tip of a program's tools cuts, judged by its motions alone.
struct CutExtents {
  BoxStock tip_mm;  ///< box of the tip
  /// Where the top of the stock probably is: Z 0 if the program cuts below it, or the highest level
  /// at which it cuts along the surface.
  double top_mm = 0;
  bool zero_at_table = false;  ///< most of the path lies above Z 0, which is then the table's
};

/// Returns the extents of the feeds, or nullopt if there are none. Retractions do not count, nor do
/// feeds at one level that follow them: on a machine whose tool is upright these are traverses. In
/// Z a feed counts at its end only, because it may begin in the air.
std::optional<CutExtents> cut_extents(std::span<const ProgramMotion> motions);

}  // namespace kerf
