// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/triangle_pair.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace kerf {
namespace {

using Point = std::array<float, 3>;

/// Bound of the relative rounding error of a determinant of float differences, as a share of the
/// sum of its products' sizes.
constexpr double kFilter = 1e-15;

int sign(double n) { return n > 0 ? 1 : n < 0 ? -1 : 0; }

/// A sum of doubles without rounding: parts that do not overlap, the least first. The exponents of
/// floats are so small that no part of a product of three differences is lost.
class ExactSum {
 public:
  void add(double term) {
    std::size_t kept = 0;
    for (std::size_t n = 0; n < count_; ++n) {
      const double sum = term + parts_[n];
      const double of_part = sum - term;
      const double rest = (term - (sum - of_part)) + (parts_[n] - of_part);
      if (rest != 0) parts_[kept++] = rest;
      term = sum;
    }
    if (term != 0) parts_[kept++] = term;
    count_ = kept;
  }
  /// Adds a product of two or three doubles.
  void add(double a, double b) {
    const double product = a * b;
    add(product);
    add(std::fma(a, b, -product));
  }
  void add(double a, double b, double c) {
    const double product = a * b;
    add(product, c);
    add(std::fma(a, b, -product), c);
  }
  int sign() const { return count_ == 0 ? 0 : kerf::sign(parts_[count_ - 1]); }

 private:
  std::array<double, 224> parts_;  ///< at most one more per term: 6 products of 8 times 4
  std::size_t count_ = 0;
};

/// A difference of two floats as the sum of two doubles.
struct Difference {
  double high, low;
};
Difference difference(float a, float b) {
  const double x = double(a), y = double(b), d = x - y;
  const double of_y = x - d;
  return {d, (x - (d + of_y)) + (of_y - y)};
}

/// Returns the sign of the volume of the tetrahedron (a, b, c, d).
int orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  std::array<std::array<Difference, 3>, 3> m;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    m[0][axis] = difference(a[axis], d[axis]);
    m[1][axis] = difference(b[axis], d[axis]);
    m[2][axis] = difference(c[axis], d[axis]);
  }
  constexpr std::array<std::array<std::size_t, 3>, 3> kTurns{{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}};
  double rough = 0, sizes = 0;
  for (const auto& [x, y, z] : kTurns) {
    const double plus = m[1][y].high * m[2][z].high, minus = m[1][z].high * m[2][y].high;
    rough += m[0][x].high * (plus - minus);
    sizes += std::abs(m[0][x].high) * (std::abs(plus) + std::abs(minus));
  }
  if (std::abs(rough) > kFilter * sizes) return sign(rough);
  if (sizes == 0) return 0;
  ExactSum sum;
  const auto add = [&sum](const Difference& p, const Difference& q, const Difference& r, int s) {
    for (const double x : {p.low, p.high}) {
      for (const double y : {q.low, q.high}) {
        for (const double z : {r.low, r.high}) {
          if (x != 0 && y != 0 && z != 0) sum.add(s * x, y, z);
        }
      }
    }
  };
  for (const auto& [x, y, z] : kTurns) {
    add(m[0][x], m[1][y], m[2][z], 1);
    add(m[0][x], m[1][z], m[2][y], -1);
  }
  return sum.sign();
}

/// Returns the sign of the area of the triangle (a, b, c) in the projection along an axis.
int turn(const Point& a, const Point& b, const Point& c, std::size_t axis) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Difference au = difference(a[u], c[u]), av = difference(a[v], c[v]),
                   bu = difference(b[u], c[u]), bv = difference(b[v], c[v]);
  const double left = au.high * bv.high, right = av.high * bu.high;
  if (std::abs(left - right) > kFilter * (std::abs(left) + std::abs(right))) {
    return sign(left - right);
  }
  ExactSum sum;
  const auto add = [&sum](const Difference& p, const Difference& q, int s) {
    for (const double x : {p.low, p.high}) {
      for (const double y : {q.low, q.high}) {
        if (x != 0 && y != 0) sum.add(s * x, y);
      }
    }
  };
  add(au, bv, 1);
  add(av, bu, -1);
  return sum.sign();
}

/// Returns an axis along which the projection of a triangle has an area, or 3.
std::size_t axis_with_area(const FloatTriangle& t) {
  std::size_t axis = 0;
  while (axis < 3 && turn(t[0], t[1], t[2], axis) == 0) ++axis;
  return axis;
}

/// Returns whether a segment in the plane of a triangle meets it.
bool meets_in_plane(const Point& p, const Point& q, const FloatTriangle& t) {
  const std::size_t axis = axis_with_area(t);
  const int around = turn(t[0], t[1], t[2], axis);
  const auto inside = [&](const Point& x) {
    return std::ranges::all_of(std::array<std::size_t, 3>{0, 1, 2}, [&](std::size_t n) {
      return turn(t[n], t[(n + 1) % 3], x, axis) * around >= 0;
    });
  };
  if (inside(p) || inside(q)) return true;
  // Otherwise it meets the triangle only if it crosses two sides.
  for (std::size_t n = 0; n < 3; ++n) {
    const Point &a = t[n], &b = t[(n + 1) % 3];
    const int from = turn(a, b, p, axis), to = turn(a, b, q, axis);
    if (from == 0 && to == 0) continue;
    if (from * to <= 0 && turn(p, q, a, axis) * turn(p, q, b, axis) <= 0) return true;
  }
  return false;
}

/// Returns whether a segment meets a triangle.
bool meets(const Point& p, const Point& q, const FloatTriangle& t) {
  const int from = orientation(t[0], t[1], t[2], p), to = orientation(t[0], t[1], t[2], q);
  if (from * to > 0) return false;
  if (from == 0 && to == 0) return meets_in_plane(p, q, t);
  bool left = false, right = false;
  for (std::size_t n = 0; n < 3; ++n) {
    const int side = orientation(p, q, t[n], t[(n + 1) % 3]);
    left |= side > 0;
    right |= side < 0;
  }
  return !(left && right);
}

}  // namespace

bool has_no_area(const FloatTriangle& t) { return axis_with_area(t) == 3; }

bool do_cross(const FloatTriangle& s, const FloatTriangle& t) {
  std::array<std::size_t, 3> in_s{}, in_t{};  // numbers of common corners
  std::size_t common = 0;
  for (std::size_t m = 0; m < 3; ++m) {
    for (std::size_t n = 0; n < 3; ++n) {
      if (s[m] != t[n]) continue;
      in_s[common] = m;
      in_t[common++] = n;
      break;
    }
  }
  if (common == 0) {
    for (std::size_t n = 0; n < 3; ++n) {
      if (meets(s[n], s[(n + 1) % 3], t) || meets(t[n], t[(n + 1) % 3], s)) return true;
    }
    return false;
  }
  if (common == 1) {
    return meets(s[(in_s[0] + 1) % 3], s[(in_s[0] + 2) % 3], t) ||
           meets(t[(in_t[0] + 1) % 3], t[(in_t[0] + 2) % 3], s);
  }
  if (common == 3) return true;
  // They share an edge, and overlap if one is folded onto the other.
  const Point &of_s = s[3 - in_s[0] - in_s[1]], &of_t = t[3 - in_t[0] - in_t[1]];
  if (orientation(s[0], s[1], s[2], of_t) != 0) return false;
  const std::size_t axis = axis_with_area(s);
  const Point &a = s[in_s[0]], &b = s[in_s[1]];
  return turn(a, b, of_s, axis) == turn(a, b, of_t, axis);
}

}  // namespace kerf
