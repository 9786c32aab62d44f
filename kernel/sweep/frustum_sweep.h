#pragma once

#include <array>
#include <variant>

#include "kernel/intersect/ray_cone.h"
#include "kernel/intersect/ray_parallelogram.h"
#include "kernel/intersect/ray_pipe.h"
#include "kernel/sweep/column_row.h"
#include "kernel/sweep/outline.h"
#include "kernel/sweep/turning_contact.h"
#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// A truncated cone of the tool between two poses. Its start and end are exact; in between every
/// material point moves on the straight line that joins its two positions, to second order in the
/// turn (kernel/README.md, "The tight model"): exact for a translation. The turn should be small;
/// sweep_tool subdivides.
class FrustumSweep {
 public:
  FrustumSweep(const FrustumPiece& piece, const ToolPose& from, const ToolPose& to);

  SweepBounds bounds() const;
  LowerPlane lower_plane() const;
  XRange row_range(double y_mm) const { return outline_.row(y_mm); }
  /// Fills lo and hi of every column of the row.
  void evaluate(ColumnRow& row) const;

 private:
  /// What a translation adds between start and end (paper Eq. 11): two sides, and a pipe for each
  /// rim.
  struct TranslationEnvelope {
    RayParallelogram left, right;
    RayPipe lower, upper;
  };
  using Envelope = std::variant<TranslationEnvelope, TurningFrustum>;

  static TranslationEnvelope translate(const RayCone& start, const FrustumPiece& piece, Vec3 d);
  static Envelope make_envelope(const RayCone& start, const FrustumPiece& piece,
                                const ToolPose& from, const ToolPose& to);

  FrustumPiece piece_;
  RayCone start_, end_;
  Outline outline_;
  Envelope envelope_;
};

}  // namespace kerf
