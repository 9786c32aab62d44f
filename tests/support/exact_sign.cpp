// SPDX-License-Identifier: Apache-2.0
#include "tests/support/exact_sign.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <vector>

namespace kerf::test {
namespace {

using Exact = boost::multiprecision::cpp_int;

/// A float as a multiple of 2^-149, the least positive one.
Exact exact(float value) {
  int exponent = 0;
  const float fraction = std::frexp(value, &exponent);  // value = fraction 2^exponent
  constexpr int kBits = 24;
  Exact n = static_cast<std::int64_t>(std::ldexp(fraction, kBits));
  const int shift = exponent - kBits + 149;
  return shift >= 0 ? Exact(n << shift) : Exact(n >> -shift);
}

int sign(const Exact& n) { return n.sign(); }
int sign(double n) { return n > 0 ? 1 : n < 0 ? -1 : 0; }

template <class T>
T difference(float a, float b);
template <>
double difference<double>(float a, float b) {
  return double(a) - double(b);
}
template <>
Exact difference<Exact>(float a, float b) {
  return exact(a) - exact(b);
}

template <class T>
std::array<T, 3> difference(const FloatPoint& a, const FloatPoint& b) {
  return {difference<T>(a[0], b[0]), difference<T>(a[1], b[1]), difference<T>(a[2], b[2])};
}

template <class T>
T determinant(const std::array<T, 3>& a, const std::array<T, 3>& b, const std::array<T, 3>& c) {
  return T(a[0] * T(b[1] * c[2] - b[2] * c[1])) + T(a[1] * T(b[2] * c[0] - b[0] * c[2])) +
         T(a[2] * T(b[0] * c[1] - b[1] * c[0]));
}

/// Exceeds the relative rounding error of a determinant of three by three differences, as a share
/// of the sum of the products' sizes (J. Shewchuk, Adaptive precision floating-point arithmetic and
/// fast robust geometric predicates, 1997).
constexpr double kFilter = 1e-15;

/// Returns whether a difference of two floats is exact in doubles.
bool exact_in_double(float a, float b) {
  const double d = double(a) - double(b);
  return double(b) + d == double(a) && double(a) - d == double(b);
}

bool contains(const FloatTriangle& t, const FloatPoint& p) {
  return std::ranges::find(t, p) != t.end();
}

/// Returns an axis along which the projection of a triangle has an area.
std::size_t projection_of(const FloatTriangle& t) {
  std::size_t axis = 0;
  while (axis < 2 && projected_orientation(t[0], t[1], t[2], axis) == 0) ++axis;
  return axis;
}

/// Returns whether a segment meets a triangle in its plane.
bool meets_in_plane(const FloatPoint& p, const FloatPoint& q, const FloatTriangle& t) {
  const std::size_t axis = projection_of(t);
  const auto side = [axis](const FloatPoint& a, const FloatPoint& b, const FloatPoint& c) {
    return projected_orientation(a, b, c, axis);
  };
  const int turn = side(t[0], t[1], t[2]);
  const auto inside = [&](const FloatPoint& x) {
    return side(t[0], t[1], x) * turn >= 0 && side(t[1], t[2], x) * turn >= 0 &&
           side(t[2], t[0], x) * turn >= 0;
  };
  if (inside(p) || inside(q)) return true;
  for (std::size_t n = 0; n < 3; ++n) {
    const FloatPoint &a = t[n], &b = t[(n + 1) % 3];
    const int ap = side(a, b, p), aq = side(a, b, q), pa = side(p, q, a), pb = side(p, q, b);
    // Collinear segments that overlap have an end inside the triangle, or reach another side.
    if (ap * aq <= 0 && pa * pb <= 0 && !(ap == 0 && aq == 0)) return true;
  }
  return false;
}

bool meets(const FloatPoint& p, const FloatPoint& q, const FloatTriangle& t) {
  const int from = orientation(t[0], t[1], t[2], p), to = orientation(t[0], t[1], t[2], q);
  if (from * to > 0) return false;
  if (from == 0 && to == 0) return meets_in_plane(p, q, t);
  const int a = orientation(p, q, t[0], t[1]), b = orientation(p, q, t[1], t[2]),
            c = orientation(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

}  // namespace

int orientation(const FloatPoint& a, const FloatPoint& b, const FloatPoint& c,
                const FloatPoint& d) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (a[axis] == b[axis] && a[axis] == c[axis] && a[axis] == d[axis]) return 0;
  }
  const auto u = difference<double>(a, d), v = difference<double>(b, d),
             w = difference<double>(c, d);
  const double rough = determinant(u, v, w);
  const auto size = [](double n) { return std::abs(n); };
  const double sizes = size(u[0]) * (size(v[1] * w[2]) + size(v[2] * w[1])) +
                       size(u[1]) * (size(v[2] * w[0]) + size(v[0] * w[2])) +
                       size(u[2]) * (size(v[0] * w[1]) + size(v[1] * w[0]));
  if (std::abs(rough) > kFilter * sizes) return sign(rough);
  return sign(
      determinant(difference<Exact>(a, d), difference<Exact>(b, d), difference<Exact>(c, d)));
}

int projected_orientation(const FloatPoint& a, const FloatPoint& b, const FloatPoint& c,
                          std::size_t axis) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double left = (double(a[u]) - double(c[u])) * (double(b[v]) - double(c[v]));
  const double right = (double(a[v]) - double(c[v])) * (double(b[u]) - double(c[u]));
  if (std::abs(left - right) > kFilter * (std::abs(left) + std::abs(right))) {
    return sign(left - right);
  }
  if (exact_in_double(a[u], c[u]) && exact_in_double(b[v], c[v]) && exact_in_double(a[v], c[v]) &&
      exact_in_double(b[u], c[u])) {
    // A product is the sum of its nearest double and an error, which is also a double.
    const double left_rest =
        std::fma(double(a[u]) - double(c[u]), double(b[v]) - double(c[v]), -left);
    const double right_rest =
        std::fma(double(a[v]) - double(c[v]), double(b[u]) - double(c[u]), -right);
    return left != right ? sign(left - right) : sign(left_rest - right_rest);
  }
  const Exact l = difference<Exact>(a[u], c[u]) * difference<Exact>(b[v], c[v]);
  const Exact r = difference<Exact>(a[v], c[v]) * difference<Exact>(b[u], c[u]);
  return sign(Exact(l - r));
}

bool are_collinear(const FloatPoint& a, const FloatPoint& b, const FloatPoint& c) {
  return projected_orientation(a, b, c, 0) == 0 && projected_orientation(a, b, c, 1) == 0 &&
         projected_orientation(a, b, c, 2) == 0;
}

bool do_intersect(const FloatTriangle& s, const FloatTriangle& t) {
  std::vector<FloatPoint> common, of_s, of_t;
  for (const FloatPoint& p : s) (contains(t, p) ? common : of_s).push_back(p);
  for (const FloatPoint& p : t) {
    if (!contains(s, p)) of_t.push_back(p);
  }
  switch (common.size()) {
    case 0:
      for (std::size_t n = 0; n < 3; ++n) {
        if (meets(s[n], s[(n + 1) % 3], t) || meets(t[n], t[(n + 1) % 3], s)) return true;
      }
      return false;
    case 1:
      return meets(of_s[0], of_s[1], t) || meets(of_t[0], of_t[1], s);
    case 2: {
      if (orientation(s[0], s[1], s[2], of_t[0]) != 0) return false;
      const std::size_t axis = projection_of(s);
      return projected_orientation(common[0], common[1], of_s[0], axis) ==
             projected_orientation(common[0], common[1], of_t[0], axis);
    }
    default:
      return true;
  }
}

}  // namespace kerf::test
