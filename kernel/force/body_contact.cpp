// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/body_contact.h"

#include <algorithm>

namespace kerf {

void BodyContact::add(const ContactPlane& plane) {
  if (count_ < kPlanesMax) {
    planes_[count_++] = plane;
    return;
  }
  ContactPlane& least = *std::ranges::min_element(planes_, {}, &ContactPlane::depth_mm);
  if (plane.depth_mm > least.depth_mm) least = plane;
}

std::span<const ContactPlane> BodyContact::shared() {
  const std::span<ContactPlane> planes = std::span(planes_).first(count_);
  for (ContactPlane& plane : planes) {
    if (!(plane.depth_mm > 0)) continue;
    double deepest_mm = plane.depth_mm, weight = 0;
    for (const ContactPlane& other : planes) {
      if (!(other.depth_mm > 0)) continue;
      const double along = &other == &plane ? 1 : std::max(0.0, dot(other.normal, plane.normal));
      deepest_mm = std::max(deepest_mm, along * other.depth_mm);
      weight += along * other.depth_mm * other.depth_mm;
    }
    plane.stiffness_n_per_mm *= deepest_mm * plane.depth_mm / weight;
  }
  return planes;
}

}  // namespace kerf
