// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <vector>

#include "server/formats/control/area_path.h"

namespace kerf {

/// A point of a plane, mm.
struct OutlinePoint {
  double x = 0, y = 0;
};
/// A straight move of the tool's center within a pocket.
struct OutlineStroke {
  OutlinePoint from, to;
};

/// A pocket within any closed outline of lines and arcs, such as that of Haas's G150: the positions
/// of a tool's center that keep a distance, `inset` mm, from the outline.
class OutlinePocket {
 public:
  /// The first move of `outline` states its start, to which the last one returns.
  OutlinePocket(const AreaPath& outline, double inset);

  /// Whether the outline runs counterclockwise, so that the pocket is on its left.
  bool is_counterclockwise() const { return doubled_area_ > 0; }
  /// Whether the center may be at a point, or anywhere between two of them.
  bool is_clear(OutlinePoint at) const;
  bool is_clear(OutlinePoint from, OutlinePoint to) const;
  /// Strokes of the center along x or y, back and forth, in rows at most `step` > 0 apart, none
  /// along the outline itself. With rows at most a tool's diameter apart, strokes and one loop
  /// along the outline clear everything that the tool reaches. Error: too many strokes.
  std::expected<std::vector<OutlineStroke>, std::string> strokes(double step, bool along_x) const;
  /// The loop of the center along the outline as cutter compensation makes it: stops at the
  /// intersection of inside corners, rounds outside corners. Throws ProgramFault if the tool does
  /// not fit.
  AreaPath loop() const;

 private:
  bool is_inside(OutlinePoint at) const;
  double distance(OutlinePoint at) const;

  AreaPath outline_;
  double inset_ = 0;
  std::vector<OutlinePoint> corners_;  ///< of chords of the outline; the last is the first
  double doubled_area_ = 0;            ///< mm²; above 0: counterclockwise
};

}  // namespace kerf
