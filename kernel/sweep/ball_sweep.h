#pragma once

#include "kernel/sweep/column_row.h"

namespace kerf {

/// A ball moved on a straight line: a capsule. Exact whatever the tool's axis does meanwhile, as
/// long as the ball's centre moves straight.
class BallSweep {
 public:
  BallSweep(Vec3 from_mm, Vec3 to_mm, double radius_mm);

  SweepBounds bounds() const;
  LowerPlane lower_plane() const;
  XRange row_range(double y_mm) const;
  /// Fills lo and hi of every column of the row.
  void evaluate(ColumnRow& row) const;

 private:
  Vec3 from_, to_;
  double radius_;
};

}  // namespace kerf
