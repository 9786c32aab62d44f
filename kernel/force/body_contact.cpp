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
  const std::span<const ContactPlane> planes = std::span(planes_).first(count_);
  for (std::size_t k = 0; k < count_; ++k) {
    const ContactPlane& plane = planes[k];
    shared_[k] = plane;
    if (!(plane.depth_mm > 0)) continue;
    double deepest_mm = plane.depth_mm, weight = 0;
    for (const ContactPlane& other : planes) {
      if (!(other.depth_mm > 0)) continue;
      const double along = &other == &plane ? 1 : std::max(0.0, dot(other.normal, plane.normal));
      deepest_mm = std::max(deepest_mm, along * other.depth_mm);
      weight += along * other.depth_mm * other.depth_mm;
    }
    shared_[k].stiffness_n_per_mm *= deepest_mm * plane.depth_mm / weight;
  }
  return std::span(shared_).first(count_);
}

}  // namespace kerf
