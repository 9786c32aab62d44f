// SPDX-License-Identifier: Apache-2.0
#include "server/convert/batch_sum.h"

#include <algorithm>

#include "kernel/force/contact_patch.h"

namespace kerf {

void BatchSum::add(const MotionResult& result, double duration_s) {
  impulse_.force_n = impulse_.force_n + result.wrench.force_n * duration_s;
  impulse_.torque_nmm = impulse_.torque_nmm + result.wrench.torque_nmm * duration_s;
  collision_impulse_.force_n = collision_impulse_.force_n + result.collision.force_n * duration_s;
  // A motion may be engaged without removing anything: at a wall parallel to the rays, between two
  // columns, and when the tool rests in its cut.
  if (result.cutting.engaged_area_mm2 > 0) {
    const Vec3 cut_n = result.wrench.force_n - result.collision.force_n;
    last_specific_ = length(cut_n) / result.cutting.engaged_area_mm2;
  }
  if (result.cutting.engaged_area_mm2 > 0 || result.removed_mm3 > 0) cutting_ = result.cutting;
  removed_mm3_ += result.removed_mm3;
  imprint_mm3_ += result.imprint_mm3;
  duration_s_ += duration_s;
  ++motions_;
}

void BatchSum::touch(std::span<const ContactPlane> planes) {
  planes_count_ = 0;
  for (const ContactPlane& plane : spread(planes, planes_.size())) {
    planes_[planes_count_++] = {
        .point_mm = plane.point_mm,
        .normal = Vec3f(plane.normal),
        .depth_mm = static_cast<float>(plane.depth_mm),
        .stiffness_n_per_mm = static_cast<float>(plane.stiffness_n_per_mm),
        .radius_mm = static_cast<float>(plane.radius_mm),
        .flags = (plane.stock ? wire::kContactStock : wire::kContactObstacle) |
                 (plane.continues ? wire::kContactContinues : 0U)};
  }
}

void BatchSum::write(wire::Result& result) const {
  result.plane_count = planes_count_;
  result.planes = planes_;
  if (empty() || duration_s_ <= 0) return;
  const double scale = 1 / duration_s_;
  result.force_n = Vec3f(impulse_.force_n * scale);
  result.torque_nmm = Vec3f(impulse_.torque_nmm * scale);
  result.collision_force_n = Vec3f(collision_impulse_.force_n * scale);
  result.engaged_area_mm2 = static_cast<float>(cutting_.engaged_area_mm2);
  result.direction = Vec3f(cutting_.direction);
  result.cut_centre_mm = cutting_.center_mm;
  result.specific_force_n_per_mm2 = static_cast<float>(last_specific_);
  result.removed_mm3 = static_cast<float>(removed_mm3_);
  if (removed_mm3_ > 0) result.status |= wire::kStatusCutting;
  if (imprint_mm3_ > 0) result.status |= wire::kStatusImprint;
  if (length(collision_impulse_.force_n) > 0) result.status |= wire::kStatusColliding;
}

}  // namespace kerf
