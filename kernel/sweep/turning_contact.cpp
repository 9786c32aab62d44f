#include "kernel/sweep/turning_contact.h"

namespace kerf {
namespace {

/// The unknowns of one contact in every column of a row. Newton's steps run over the whole row at
/// once, so that each is a plain loop that vectorises.
struct Unknowns {
  double l[kTileSide];                  ///< height of a side's contact
  double ew[kTileSide], ek[kTileSide];  ///< radial direction of a rim's contact
  double s[kTileSide];                  ///< share of the way, -1/2 .. 1/2
};

void include(ColumnRow& row, int i, bool hit, double z) {
  row.lo_mm[i] = (hit & (z < row.lo_mm[i])) ? z : row.lo_mm[i];
  row.hi_mm[i] = (hit & (z > row.hi_mm[i])) ? z : row.hi_mm[i];
}

KERF_VECTOR_CLONES
void step_sides(const ColumnRow& row, const TurningFrustum& f, double sign, Unknowns& u) {
  for (int i = 0; i < row.lanes; ++i) {
    const double px = row.x_mm[i] - f.base.x, py = row.y_mm - f.base.y;
    const auto [dl, ds] = SideContact(f, sign, u.l[i], u.s[i]).towards(px, py);
    u.l[i] = clamp(u.l[i] + dl, -kEdgeEpsilonMm, f.height + kEdgeEpsilonMm);
    u.s[i] = clamp(u.s[i] + ds, -0.5, 0.5);
  }
}

KERF_VECTOR_CLONES
void include_sides(ColumnRow& row, const TurningFrustum& f, double sign, const Unknowns& u) {
  for (int i = 0; i < row.lanes; ++i) {
    const double px = row.x_mm[i] - f.base.x, py = row.y_mm - f.base.y;
    const SideContact contact(f, sign, u.l[i], u.s[i]);
    include(row, i, contact.exists & contact.meets(px, py, f.straightening_mm),
            f.base.z + contact.at.z);
  }
}

KERF_VECTOR_CLONES
void start_rim(const ColumnRow& row, const TurningFrustum& f, double height, double radius,
               double sign, Unknowns& u) {
  for (int i = 0; i < row.lanes; ++i) {
    const RimStart start(f, height, radius, sign, row.x_mm[i] - f.base.x, row.y_mm - f.base.y);
    const double scale = 1 / std::sqrt(start.ew * start.ew + start.ek * start.ek);
    u.ew[i] = start.ew * scale;
    u.ek[i] = start.ek * scale;
    u.s[i] = start.s;
  }
}

KERF_VECTOR_CLONES
void step_rim(const ColumnRow& row, const TurningFrustum& f, double height, double radius,
              Unknowns& u) {
  for (int i = 0; i < row.lanes; ++i) {
    const double px = row.x_mm[i] - f.base.x, py = row.y_mm - f.base.y;
    const auto [turn, ds] = RimContact(f, height, radius, u.ew[i], u.ek[i], u.s[i]).towards(px, py);
    const double t = clamp(turn, -0.5, 0.5);
    const double scale = 1 / std::sqrt(1 + t * t);
    const double ew = (u.ew[i] - t * u.ek[i]) * scale;
    u.ek[i] = (u.ek[i] + t * u.ew[i]) * scale;
    u.ew[i] = ew;
    u.s[i] = clamp(u.s[i] + ds, -0.5, 0.5);
  }
}

KERF_VECTOR_CLONES
void include_rim(ColumnRow& row, const TurningFrustum& f, double height, double radius,
                 const Unknowns& u) {
  for (int i = 0; i < row.lanes; ++i) {
    const double px = row.x_mm[i] - f.base.x, py = row.y_mm - f.base.y;
    const RimContact contact(f, height, radius, u.ew[i], u.ek[i], u.s[i]);
    include(row, i, contact.meets(px, py, f.straightening_mm), f.base.z + contact.at.z);
  }
}

void include_side_contacts(ColumnRow& row, const TurningFrustum& f, double sign,
                           double start_height) {
  Unknowns u;
  for (int i = 0; i < row.lanes; ++i) {
    u.l[i] = start_height;
    u.s[i] = 0;
  }
  for (int step = 0; step < kContactSteps; ++step) step_sides(row, f, sign, u);
  include_sides(row, f, sign, u);
}

void include_rim_contacts(ColumnRow& row, const TurningFrustum& f, double height, double radius) {
  if (radius <= 0) return;
  for (const double sign : {1.0, -1.0, 0.0}) {
    Unknowns u;
    start_rim(row, f, height, radius, sign, u);
    for (int step = 0; step < kContactSteps; ++step) step_rim(row, f, height, radius, u);
    include_rim(row, f, height, radius, u);
  }
}

}  // namespace

void include_turning_contacts(ColumnRow& row, const TurningFrustum& f, const FrustumPiece& piece) {
  for (const double sign : {1.0, -1.0}) {
    include_side_contacts(row, f, sign, f.height / 2);
    // Towards the point of a cone the contact curve bends away from where a search from the middle
    // looks.
    if (f.slope != 0) include_side_contacts(row, f, sign, f.height / 16);
  }
  include_rim_contacts(row, f, 0, piece.r0_mm);
  include_rim_contacts(row, f, f.height, piece.r1_mm);
}

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
  const double radius = piece.r0_mm > piece.r1_mm ? piece.r0_mm : piece.r1_mm;
  const double reach = std::sqrt(piece.z1_mm * piece.z1_mm + radius * radius);
  straightening_mm = reach * omega * omega / 8;  // reach (1 − cos(turn / 2))
}

}  // namespace kerf
