// SPDX-License-Identifier: Apache-2.0
#include "kernel/piece/tool_piece.h"

namespace kerf {

double radius_at(const ToolPiece& piece, double z_mm) {
  return std::visit([&](const auto& p) { return radius_at(p, z_mm); }, piece);
}

double slope_at(const ToolPiece& piece, double z_mm) {
  return std::visit([&](const auto& p) { return slope_at(p, z_mm); }, piece);
}

Extent extent(const ToolPiece& piece) {
  return std::visit([](const auto& p) { return extent(p); }, piece);
}

FrustumPiece enclosing_frustum(const ToolPiece& piece) {
  if (const auto* frustum = std::get_if<FrustumPiece>(&piece)) return *frustum;
  const Extent e = extent(piece);
  return {e.z0_mm, e.radius_mm, e.z1_mm, e.radius_mm};
}

ToolPiece slice_of(const ToolPiece& piece, double z0_mm, double z1_mm) {
  if (const auto* arc = std::get_if<ArcPiece>(&piece)) {
    return ArcPiece{arc->center_r_mm, arc->center_z_mm, arc->radius_mm, z0_mm, z1_mm};
  }
  const auto& f = std::get<FrustumPiece>(piece);
  return FrustumPiece{z0_mm, radius_at(f, z0_mm), z1_mm, radius_at(f, z1_mm)};
}

PieceProfile::PieceProfile(const ToolPiece& piece) {
  const Extent e = extent(piece);
  z0_mm = e.z0_mm;
  z1_mm = e.z1_mm;
  if (const auto* frustum = std::get_if<FrustumPiece>(&piece)) {
    side = Side::kLine;
    line = FrustumSide(*frustum);
  } else if (const auto* ball = std::get_if<BallPiece>(&piece)) {
    side = Side::kBall;
    center_z_mm = ball->center_mm;
    radius_mm = ball->radius_mm;
  } else {
    const auto& arc = std::get<ArcPiece>(piece);
    side = Side::kArc;
    center_r_mm = arc.center_r_mm;
    center_z_mm = arc.center_z_mm;
    radius_mm = arc.radius_mm;
  }
}

}  // namespace kerf
