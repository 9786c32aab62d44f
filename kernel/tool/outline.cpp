// SPDX-License-Identifier: Apache-2.0
#include "kernel/tool/outline.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

/// Returns whether the part of the ball above the arc is inside the line that follows: that line
/// leaves the arc outside the circle's tangent, and is as high as the ball.
bool covers_rest(const OutlineArc& arc, const OutlineSection* next) {
  const double top = arc.center.h_mm + arc.radius_mm;
  if (arc.to.h_mm >= top) return true;
  const auto* line = next == nullptr ? nullptr : std::get_if<OutlineLine>(next);
  if (line == nullptr) return false;
  const double rise = line->to.h_mm - line->from.h_mm;
  if (rise <= kOutlineEpsilonMm || line->to.h_mm < top) return false;
  if (line->from.r_mm < arc.to.r_mm - kOutlineEpsilonMm) return false;
  // The circle's own slope where the arc ends is −(h − center_h) / r.
  const double slope = (line->to.r_mm - line->from.r_mm) / rise;
  return slope * arc.to.r_mm >= arc.center.h_mm - arc.to.h_mm - kOutlineEpsilonMm;
}

bool is_ball(const OutlineArc& arc, const OutlineSection* next) {
  return std::abs(arc.center.r_mm) <= kOutlineEpsilonMm && arc.from.r_mm <= kOutlineEpsilonMm &&
         covers_rest(arc, next);
}

/// Makes an arc piece. If rounding puts an end beyond the arc's pole, the radius is enlarged, so
/// that radius² − (h − center_h)² is nowhere negative.
ArcPiece arc_piece(const OutlineArc& arc, double z0, double z1) {
  const double radius =
      std::max({arc.radius_mm, std::abs(z0 - arc.center.h_mm), std::abs(z1 - arc.center.h_mm)});
  return {arc.center.r_mm, arc.center.h_mm, radius, z0, z1};
}

}  // namespace

std::vector<ToolPiece> pieces_of(const std::vector<OutlineSection>& outline) {
  std::vector<ToolPiece> pieces;
  double z0 = 0;  // end of the last piece: pieces touch even if a low section was skipped
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const OutlineSection* next = i + 1 < outline.size() ? &outline[i + 1] : nullptr;
    const ProfilePoint from = std::visit([](const auto& s) { return s.from; }, outline[i]);
    const ProfilePoint to = std::visit([](const auto& s) { return s.to; }, outline[i]);
    if (i == 0) z0 = from.h_mm;
    if (to.h_mm - z0 <= kOutlineEpsilonMm) continue;
    const auto* arc = std::get_if<OutlineArc>(&outline[i]);
    if (arc == nullptr) {
      pieces.emplace_back(FrustumPiece{z0, from.r_mm, to.h_mm, to.r_mm});
    } else if (is_ball(*arc, next)) {
      pieces.emplace_back(BallPiece{arc->center.h_mm, arc->radius_mm});
    } else {
      pieces.emplace_back(arc_piece(*arc, z0, to.h_mm));
    }
    z0 = to.h_mm;
  }
  return pieces;
}

}  // namespace kerf
