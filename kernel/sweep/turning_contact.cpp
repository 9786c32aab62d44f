#include "kernel/sweep/turning_contact.h"

namespace kerf {

TurningFrustum::TurningFrustum(const FrustumPiece& piece, const ToolPose& from,
                               const ToolPose& to) {
  const Vec3 turn = cross(from.axis, to.axis);
  u = normalized(from.axis + to.axis);
  k = normalized(turn);
  w = cross(k, u);
  omega = length(to.axis - from.axis);
  const Vec3 v = to.tip_mm - from.tip_mm;
  base = (from.tip_mm + to.tip_mm) * 0.5 + u * piece.z0_mm;
  height = piece.z1_mm - piece.z0_mm;
  r0 = piece.r0_mm;
  slope = (piece.r1_mm - piece.r0_mm) / height;
  va = dot(v, w) + piece.z0_mm * omega;
  vb = dot(v, k);
  vc = dot(v, u);
}

}  // namespace kerf
