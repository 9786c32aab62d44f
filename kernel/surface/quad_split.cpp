// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/quad_split.h"

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Returns whether the plane of a triangle passes between the ends of the edge, with the upper end
/// on its upper side. On the side of the diagonal towards the edge, this is where the triangle
/// meets the edge; on the other side it bounds the diagonal.
bool passes_edge(Vec3 a, Vec3 b, Vec3 c, double slack_share) {
  const Vec3 normal = cross(b - a, c - a);
  const double height = dot(normal, a);  // height of the plane on the edge, times normal.z
  const double slack = slack_share * normal.z;
  return normal.z > 0 && height >= -slack && height <= normal.z + slack;
}

bool fits(const std::array<Vec3, 4>& c, std::size_t from, double slack) {
  return passes_edge(c[from], c[from + 1], c[from + 2], slack) &&
         passes_edge(c[from], c[from + 2], c[(from + 3) % 4], slack);
}

}  // namespace

QuadSplit split_within_envelope(const std::array<Vec3, 4>& corners, bool flat,
                                QuadSplit preferred) {
  const double slack = flat ? kEnvelopeSlack : -kEnvelopeSlack;
  const std::size_t first = preferred == QuadSplit::kSecond ? 1 : 0;
  if (fits(corners, first, slack)) return first == 0 ? QuadSplit::kFirst : QuadSplit::kSecond;
  if (fits(corners, 1 - first, slack)) return first == 0 ? QuadSplit::kSecond : QuadSplit::kFirst;
  return QuadSplit::kFan;
}

}  // namespace kerf
