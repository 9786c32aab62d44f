#include "kernel/sweep/frustum_sweep.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

/// Squared sine of the lean from which on a plane along the axis bounds the piece better than a
/// level one.
constexpr double kLeanForPlane = 1e-4;

RayCone at_pose(const FrustumPiece& p, const ToolPose& pose) {
  return {pose.tip_mm + pose.axis * p.z0_mm, pose.axis, p.z1_mm - p.z0_mm, p.r0_mm, p.r1_mm};
}

/// The two generators of the side along which n·V = 0 (paper Eqs. 1–8, with cosines instead of
/// angles): radial directions e with (e − k u)·d = 0. None where the whole side is lit or dark, |k
/// d·u| > |d⊥|: `exist` is false.
struct CuttingProfile {
  Vec3 radial[2];
  bool exist;
};

CuttingProfile cutting_profile(Vec3 u, double slope, Vec3 d) {
  const double du = dot(d, u);
  const Vec3 across = d - u * du;
  const double n = length(across);
  const double cosine = slope * du / n;
  if (!(std::abs(cosine) <= 1)) return {{}, false};
  const Vec3 a = across * (1 / n);
  const Vec3 b = cross(u, a);
  const double sine = std::sqrt(1 - cosine * cosine);
  return {{a * cosine + b * sine, a * cosine - b * sine}, true};
}

KERF_VECTOR_CLONES
void evaluate_translated(ColumnRow& row, const RayCone& start, const RayCone& end,
                         const RayParallelogram& left, const RayParallelogram& right,
                         const RayPipe& lower, const RayPipe& upper) {
  for (int i = 0; i < row.lanes; ++i) {
    Span span;
    const double x = row.x_mm[i], y = row.y_mm;
    start.extend(span, x, y);
    end.extend(span, x, y);
    left.extend(span, x, y);
    right.extend(span, x, y);
    lower.extend(span, x, y);
    upper.extend(span, x, y);
    row.lo_mm[i] = span.lo;
    row.hi_mm[i] = span.hi;
  }
}

KERF_VECTOR_CLONES
void evaluate_standing(ColumnRow& row, const RayCone& start, const RayCone& end) {
  for (int i = 0; i < row.lanes; ++i) {
    Span span;
    start.extend(span, row.x_mm[i], row.y_mm);
    end.extend(span, row.x_mm[i], row.y_mm);
    row.lo_mm[i] = span.lo;
    row.hi_mm[i] = span.hi;
  }
}

}  // namespace

FrustumSweep::FrustumSweep(const FrustumPiece& piece, const ToolPose& from, const ToolPose& to)
    : piece_(piece),
      start_(at_pose(piece, from)),
      end_(at_pose(piece, to)),
      outline_({start_.base, start_.base + start_.axis * start_.height, end_.base,
                end_.base + end_.axis * end_.height},
               std::max(piece.r0_mm, piece.r1_mm)),
      envelope_(make_envelope(start_, piece, from, to)) {}

FrustumSweep::TranslationEnvelope FrustumSweep::translate(const RayCone& start,
                                                          const FrustumPiece& piece, Vec3 d) {
  const CuttingProfile profile = cutting_profile(start.axis, start.slope, d);
  const auto side = [&](Vec3 e) {
    // Without a cutting profile the parallelogram collapses and is met nowhere.
    if (!profile.exist) return RayParallelogram(start.base, {}, {});
    return RayParallelogram(start.base + e * start.r0,
                            (start.axis + e * start.slope) * start.height, d);
  };
  return {side(profile.radial[0]), side(profile.radial[1]),
          RayPipe(start.base, start.axis, piece.r0_mm, d),
          RayPipe(start.base + start.axis * start.height, start.axis, piece.r1_mm, d)};
}

FrustumSweep::Envelope FrustumSweep::make_envelope(const RayCone& start, const FrustumPiece& piece,
                                                   const ToolPose& from, const ToolPose& to) {
  if (from.axis == to.axis) return translate(start, piece, to.tip_mm - from.tip_mm);
  return TurningFrustum(piece, from, to);
}

SweepBounds FrustumSweep::bounds() const {
  SweepBounds b{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
  for (const RayCone& cone : {start_, end_}) {
    const Vec3 u = cone.axis;
    // Half-widths of a disc of radius 1 normal to u.
    const Vec3 w{std::sqrt(std::max(0.0, 1 - u.x * u.x)), std::sqrt(std::max(0.0, 1 - u.y * u.y)),
                 std::sqrt(std::max(0.0, 1 - u.z * u.z))};
    for (const bool upper : {false, true}) {
      const Vec3 c = cone.base + u * (upper ? cone.height : 0);
      const Vec3 h = w * (upper ? piece_.r1_mm : piece_.r0_mm);
      b.min_mm = {std::min(b.min_mm.x, c.x - h.x), std::min(b.min_mm.y, c.y - h.y),
                  std::min(b.min_mm.z, c.z - h.z)};
      b.max_mm = {std::max(b.max_mm.x, c.x + h.x), std::max(b.max_mm.y, c.y + h.y),
                  std::max(b.max_mm.z, c.z + h.z)};
    }
  }
  return b;
}

LowerPlane FrustumSweep::lower_plane() const {
  const LowerPlane level{bounds().min_mm.z, 0, 0};
  const Vec3 u = normalized(start_.axis + end_.axis);
  const double lean2 = u.x * u.x + u.y * u.y;
  if (!(lean2 > kLeanForPlane && u.z > 0)) return level;
  // The plane along the middle axis that touches the piece from below: n is the upward normal of
  // the axis. Discs reach their radius below their centres along n; sines of the half turn are
  // covered by taking whole radii.
  const double lean = std::sqrt(lean2);
  const Vec3 n{-u.x * u.z / lean, -u.y * u.z / lean, lean};
  double support = 1e300;
  for (const RayCone& cone : {start_, end_}) {
    support = std::min({support, dot(n, cone.base) - piece_.r0_mm,
                        dot(n, cone.base + cone.axis * cone.height) - piece_.r1_mm});
  }
  return {support / n.z, -n.x / n.z, -n.y / n.z};
}

void FrustumSweep::evaluate(ColumnRow& row) const {
  if (const auto* e = std::get_if<TranslationEnvelope>(&envelope_)) {
    evaluate_translated(row, start_, end_, e->left, e->right, e->lower, e->upper);
    return;
  }
  const auto& turning = std::get<TurningFrustum>(envelope_);
  evaluate_standing(row, start_, end_);
  include_turning_contacts(row, turning, piece_);
}

}  // namespace kerf
