#include "kernel/sweep/ball_sweep.h"

#include "kernel/intersect/ray_cylinder.h"
#include "kernel/intersect/ray_sphere.h"
#include "kernel/sweep/outline.h"

namespace kerf {
namespace {

KERF_VECTOR_CLONES
void evaluate_row(ColumnRow& row, const RaySphere& start, const RayCylinder& envelope,
                  const RaySphere& end) {
  for (int i = 0; i < row.lanes; ++i) {
    Span span;
    start.extend(span, row.x_mm[i], row.y_mm);
    envelope.extend(span, row.x_mm[i], row.y_mm);
    end.extend(span, row.x_mm[i], row.y_mm);
    row.lo_mm[i] = span.lo;
    row.hi_mm[i] = span.hi;
  }
}

}  // namespace

BallSweep::BallSweep(Vec3 from_mm, Vec3 to_mm, double radius_mm)
    : from_(from_mm), to_(to_mm), radius_(radius_mm) {}

SweepBounds BallSweep::bounds() const {
  const Vec3 r{radius_, radius_, radius_};
  return {Vec3{std::min(from_.x, to_.x), std::min(from_.y, to_.y), std::min(from_.z, to_.z)} - r,
          Vec3{std::max(from_.x, to_.x), std::max(from_.y, to_.y), std::max(from_.z, to_.z)} + r};
}

LowerPlane BallSweep::lower_plane() const { return {bounds().min_mm.z, 0, 0}; }

XRange BallSweep::row_range(double y_mm) const {
  return Outline({from_, to_, to_, to_}, radius_).row(y_mm);
}

void BallSweep::evaluate(ColumnRow& row) const {
  const double r2 = radius_ * radius_;
  evaluate_row(row, RaySphere{from_, r2}, RayCylinder(from_, to_ - from_, radius_),
               RaySphere{to_, r2});
}

}  // namespace kerf
