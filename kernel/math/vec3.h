// SPDX-License-Identifier: Apache-2.0
#pragma once

// This header includes nothing, so that the wire and the agent can use it without depending on the
// rest of the kernel. It calls compiler built-ins in place of <cmath>.

namespace kerf {

struct Vec3f;

/// A vector in right-handed space, +Z up: a position (mm), a direction, a force and so on,
/// according to the name of the variable.
struct Vec3 {
  double x = 0, y = 0, z = 0;

  /// Rounds each component to float.
  constexpr explicit operator Vec3f() const noexcept;
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

/// Storage for a vector of floats. Computations convert it to Vec3 first.
struct Vec3f {
  float x = 0, y = 0, z = 0;

  /// Exact.
  constexpr explicit operator Vec3() const noexcept {
    return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
  }
  friend constexpr bool operator==(const Vec3f&, const Vec3f&) = default;
};

constexpr Vec3::operator Vec3f() const noexcept {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

constexpr Vec3 operator+(Vec3 a, Vec3 b) noexcept { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(Vec3 a, Vec3 b) noexcept { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(Vec3 a) noexcept { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(Vec3 a, double s) noexcept { return {a.x * s, a.y * s, a.z * s}; }
constexpr Vec3 operator*(double s, Vec3 a) noexcept { return a * s; }
constexpr double dot(Vec3 a, Vec3 b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3 a) noexcept { return __builtin_sqrt(dot(a, a)); }
inline bool is_finite(Vec3 a) noexcept {
  return __builtin_isfinite(a.x) && __builtin_isfinite(a.y) && __builtin_isfinite(a.z);
}

/// Returns a / |a|; the zero vector stays zero.
inline Vec3 normalized(Vec3 a) noexcept {
  const double n = length(a);
  return n > 0 ? Vec3{a.x / n, a.y / n, a.z / n} : Vec3{};
}

}  // namespace kerf
