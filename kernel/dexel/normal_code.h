// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>

#include "kernel/math/int_lanes.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// A unit vector in 32 bits, octahedrally encoded with 16 bits per coordinate (Meyer et al., On
/// Floating-Point Normal Vectors, 2010). The error is at most 0.004 degrees, and 0 along the axes.
/// Codes of vectors are at least 2¹⁶. 0 marks an end of the stock's own surface, and LazyNormals
/// uses the codes between.
using NormalCode = std::uint32_t;

inline constexpr NormalCode kStockNormal = 0;

inline constexpr double kNormalSteps = 32767;  ///< from the center of the square to its side

/// Computes the octahedral coordinates (u, v) of a vector (Vec3 or Vec3Lanes, of any length except
/// 0), both in [−1, 1].
template <class AnyVec3, class Real>
KERF_INLINE void unfold_normal(const AnyVec3& n, Real& u, Real& v) {
  const Real ax = select(n.x < 0.0, -n.x, n.x), ay = select(n.y < 0.0, -n.y, n.y);
  const Real inverse = 1 / (ax + ay + select(n.z < 0.0, -n.z, n.z));
  const Real p = ax * inverse, q = ay * inverse;
  const auto lower = n.z < 0.0;
  u = select(lower, 1 - q, p);
  v = select(lower, 1 - p, q);
  u = select(n.x < 0.0, -u, u);
  v = select(n.y < 0.0, -v, v);
}

/// Encodes a vector of any length except 0.
NormalCode encode_normal(Vec3 normal);
/// Encodes eight vectors.
template <class Vec3Lanes>
KERF_INLINE void encode_normals(const Vec3Lanes& normals, NormalCode* codes) {
  Lanes u, v;
  unfold_normal(normals, u, v);
  u = u * kNormalSteps + (kNormalSteps + 1.5);
  v = v * kNormalSteps + (kNormalSteps + 1.5);
  const IntLanes packed = to_int_lanes(u) << 16 | to_int_lanes(v);
  std::memcpy(codes, &packed, sizeof packed);
}
/// Returns the unit vector of a code, which must not be kStockNormal.
Vec3 decode_normal(NormalCode code);

/// The codes of the outward normals at the two ends of an element, in the frame of its field.
struct EndCodes {
  NormalCode bottom = kStockNormal, top = kStockNormal;
  friend constexpr bool operator==(const EndCodes&, const EndCodes&) = default;
};

}  // namespace kerf
