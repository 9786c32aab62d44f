// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "kernel/piece/bounds.h"
#include "kernel/sculpture.h"
#include "server/convert/rejection.h"
#include "server/rights/region.h"
#include "server/session/participant_state.h"

namespace kerf {

/// Returns a box around all that a motion cuts, whatever the motion model: the tip's segment, the
/// tool's length along every axis of the arc, the radius, and `margin_mm` on each side.
Bounds swept_bounds(const MoveTool& move, const Tool& tool, double margin_mm);

/// The reserved regions of a block. A motion whose bounds reach into the stock inside a region is
/// rejected, before it is journaled, unless its participant may cut there. The bounds are larger
/// than the actual cut, so a motion that passes close by may be rejected too. Replay does not check
/// regions: the journal holds only accepted motions.
class Reserved {
 public:
  explicit Reserved(const SculptureSettings& settings);

  /// Replaces the regions, clipped to the stock.
  void set(const std::vector<Region>& regions);
  bool is_empty() const { return regions_.empty(); }
  std::optional<Rejection> judge(const ParticipantState& state, const MoveTool& move,
                                 const Tool& tool) const;

 private:
  Bounds stock_;
  double margin_mm_;
  std::vector<Region> regions_;
};

}  // namespace kerf
