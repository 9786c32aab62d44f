// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

#include "server/formats/program.h"

namespace kerf {

/// The region that the tip of a program's tools cuts, judged by its motions alone.
struct CutExtents {
  BoxStock tip_mm;  ///< box of the tip
  /// The probable top of the stock: Z 0 if the program cuts below it, or the highest level at which
  /// it cuts along the surface.
  double top_mm = 0;
  bool zero_at_table = false;  ///< most of the path is above Z 0, which is then the table
};

/// Finds the extents of the feeds: look() at all motions of a program, then add() all. Retractions
/// do not count, nor do feeds at one level that follow them, which are traverses of an upright
/// tool. In Z only the end of a feed counts, because it may begin in the air.
class CutExtentsFinder {
 public:
  void look(const ProgramMotion& motion);
  void add(const ProgramMotion& motion);
  /// Nullopt without feeds.
  std::optional<CutExtents> result() const;

 private:
  static constexpr double kNone = -std::numeric_limits<double>::infinity();
  void extend(Vec3 tip);

  BoxStock box_{{-kNone, -kNone, -kNone}, {kNone, kNone, kNone}};
  Vec3 last_mm_{kNone, kNone, kNone};
  double highest_ = kNone, lowest_ = -kNone;
  bool in_air_ = false;
  double level_ = kNone, slope_ = kNone;
  double path_mm_ = 0, above_mm_ = 0, slope_mm_ = 0;
};

}  // namespace kerf
