#pragma once

#include <variant>

#include "kernel/math/span.h"
#include "kernel/sweep/piece_side.h"
#include "kernel/sweep/shadow.h"
#include "kernel/sweep/turning_frame.h"

namespace kerf {

/// A slice of the tool (truncated cone or arc) along the true motion between two poses whose axes
/// are less than kTurnPerFrameMaxRad apart. At `parts` + 1 stations its ends on a ray are exact;
/// between two of them the share at which an end is outermost is searched (kernel/README.md, "The
/// tight model").
class TurningSweep {
 public:
  /// `search_mm`: how near to the outermost end the search goes, measured off the surface.
  /// `shows_disc`: a disc of the slice is not hidden within its neighbours.
  TurningSweep(const std::variant<ConeSide, ArcSide>& side, const Envelope& envelope,
               const ToolPose& from, const ToolPose& to, int parts, double search_mm,
               bool shows_disc);

  const SweepBounds& bounds() const { return shadow_.bounds(); }
  void lower_bound(const Discs& discs, Lanes& z_mm) const { shadow_.lower_bound(discs, z_mm); }
  void evaluate(ColumnBlock& block) const;

  /// What the search needs to know of the motion.
  struct Path {
    TurningFrame frame;
    int parts;
    double search_mm;
    double speed_max_mm;  ///< fastest that a point of the piece moves, per unit of share
    bool shows_disc;
  };

 private:
  std::variant<ConeSide, ArcSide> side_;
  Path path_;
  Shadow shadow_;
};

}  // namespace kerf
