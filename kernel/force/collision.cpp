#include "kernel/force/collision.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/force/signed_distance.h"
#include "kernel/math/rotation.h"

namespace kerf {
namespace {

/// A piece of the tool where it stands.
struct PlacedPiece {
  Vec3 from, to, axis;  ///< ends of the piece's own axis (equal for a ball)
  double r_from, r_to;  ///< radii of the discs at the ends; the ball's radius
  bool ball;

  /// The point of the piece that lies farthest along `way`.
  Vec3 support(Vec3 way) const {
    if (ball) return from + normalized(way) * r_from;
    const Vec3 radial = normalized(way - axis * dot(way, axis));
    const Vec3 a = from + radial * r_from, b = to + radial * r_to;
    return dot(a, way) > dot(b, way) ? a : b;
  }
  Vec3 middle() const { return (from + to) * 0.5; }
};

PlacedPiece place(const ToolPiece& piece, const ToolPose& pose) {
  if (const auto* ball = std::get_if<BallPiece>(&piece)) {
    const Vec3 c = pose.tip_mm + pose.axis * ball->center_mm;
    return {c, c, pose.axis, ball->radius_mm, ball->radius_mm, true};
  }
  const auto& f = std::get<FrustumPiece>(piece);
  return {pose.tip_mm + pose.axis * f.z0_mm,
          pose.tip_mm + pose.axis * f.z1_mm,
          pose.axis,
          f.r0_mm,
          f.r1_mm,
          false};
}

SignedDistance distance(const Obstacle& obstacle, Vec3 p) {
  return std::visit([&](const auto& shape) { return signed_distance(shape, p); }, obstacle.shape);
}

constexpr int kStarts =
    5;  ///< points of the axis from which the search for the deepest point starts
constexpr int kDescentSteps = 24;
constexpr int kLineSteps = 12;

/// Moves p towards q as long as the distance falls: golden ratios are not needed for a convex
/// function over so few steps.
Vec3 lowest_between(const Obstacle& obstacle, Vec3 p, Vec3 q) {
  double lo = 0, hi = 1;
  for (int i = 0; i < kLineSteps; ++i) {
    const double a = lo + (hi - lo) / 3, b = hi - (hi - lo) / 3;
    if (distance(obstacle, p + (q - p) * a).distance_mm <=
        distance(obstacle, p + (q - p) * b).distance_mm) {
      hi = b;
    } else {
      lo = a;
    }
  }
  const Vec3 end = distance(obstacle, q).distance_mm <=
                           distance(obstacle, p + (q - p) * ((lo + hi) / 2)).distance_mm
                       ? q
                       : p + (q - p) * ((lo + hi) / 2);
  return end;
}

/// The deepest point of a convex piece in an obstacle, by conditional gradient (Frank and Wolfe
/// 1956): exact direction for convex obstacles, a local answer for meshes.
Vec3 deepest_point(const PlacedPiece& piece, const Obstacle& obstacle) {
  Vec3 p = piece.middle();
  double best = distance(obstacle, p).distance_mm;
  for (int i = 0; i < kStarts; ++i) {
    const Vec3 q = piece.from + (piece.to - piece.from) * (i / double(kStarts - 1));
    const double d = distance(obstacle, q).distance_mm;
    if (d < best) {
      best = d;
      p = q;
    }
  }
  for (int i = 0; i < kDescentSteps; ++i) {
    const SignedDistance here = distance(obstacle, p);
    const Vec3 q = lowest_between(obstacle, p, piece.support(-here.outward));
    const double gain = here.distance_mm - distance(obstacle, q).distance_mm;
    if (!(gain > 0)) break;
    p = q;
    if (gain < 1e-9) break;
  }
  return p;
}

struct Ball {
  Vec3 center;
  double radius;
};

Ball bound(const Obstacle& obstacle) {
  if (const auto* box = std::get_if<BoxObstacle>(&obstacle.shape)) {
    return {(box->min_mm + box->max_mm) * 0.5, length(box->max_mm - box->min_mm) / 2};
  }
  if (const auto* c = std::get_if<CylinderObstacle>(&obstacle.shape)) {
    return {(c->from_mm + c->to_mm) * 0.5, length(c->to_mm - c->from_mm) / 2 + c->radius_mm};
  }
  if (const auto* s = std::get_if<SphereObstacle>(&obstacle.shape)) {
    return {s->center_mm, s->radius_mm};
  }
  const auto& mesh = std::get<MeshObstacle>(obstacle.shape);
  Vec3 lo{1e300, 1e300, 1e300}, hi{-1e300, -1e300, -1e300};
  for (const auto& t : mesh.triangles) {
    for (const Vec3& v : t) {
      lo = {std::min(lo.x, v.x), std::min(lo.y, v.y), std::min(lo.z, v.z)};
      hi = {std::max(hi.x, v.x), std::max(hi.y, v.y), std::max(hi.z, v.z)};
    }
  }
  return {(lo + hi) * 0.5, length(hi - lo) / 2};
}

bool is_positive(double v) { return std::isfinite(v) && v > 0; }

std::string check_shape(const BoxObstacle& b) {
  if (!is_finite(b.min_mm) || !is_finite(b.max_mm)) return "box is not finite";
  if (!(b.min_mm.x < b.max_mm.x && b.min_mm.y < b.max_mm.y && b.min_mm.z < b.max_mm.z)) {
    return "box is empty: min_mm must be below max_mm";
  }
  return {};
}
std::string check_shape(const CylinderObstacle& c) {
  if (!is_finite(c.from_mm) || !is_finite(c.to_mm)) return "cylinder is not finite";
  if (!is_positive(c.radius_mm)) return "cylinder's radius_mm must be greater than zero";
  if (c.from_mm == c.to_mm) return "cylinder has no length: from_mm equals to_mm";
  return {};
}
std::string check_shape(const SphereObstacle& s) {
  if (!is_finite(s.center_mm)) return "sphere is not finite";
  return is_positive(s.radius_mm) ? "" : "sphere's radius_mm must be greater than zero";
}
std::string check_shape(const MeshObstacle& m) {
  if (m.triangles.empty()) return "mesh has no triangles";
  for (const auto& t : m.triangles) {
    for (const Vec3& v : t) {
      if (!is_finite(v)) return "mesh is not finite";
    }
  }
  return {};
}

}  // namespace

std::string check_obstacle(const Obstacle& obstacle) {
  if (!is_positive(obstacle.stiffness_n_per_mm)) {
    return "stiffness_n_per_mm must be greater than zero";
  }
  return std::visit([](const auto& shape) { return check_shape(shape); }, obstacle.shape);
}

Obstacles::Obstacles(std::vector<Obstacle> obstacles) {
  for (Obstacle& o : obstacles) {
    const Ball b = bound(o);
    obstacles_.push_back({std::move(o), b.center, b.radius});
  }
}

Wrench Obstacles::push(const Tool& tool, const ToolPose& pose, double pivot_mm) const {
  Wrench sum;
  const Vec3 pivot = pose.tip_mm + pose.axis * pivot_mm;
  const Vec3 tool_middle = pose.tip_mm + pose.axis * (tool.length_mm / 2);
  const double tool_radius = tool.length_mm / 2 + tool.radius_mm;
  for (const Bounded& b : obstacles_) {
    if (length(tool_middle - b.center_mm) > tool_radius + b.radius_mm) continue;
    for (const ToolPiece& piece : tool.pieces) {
      const Vec3 p = deepest_point(place(piece, pose), b.obstacle);
      const SignedDistance d = distance(b.obstacle, p);
      if (d.distance_mm >= 0) continue;
      const Vec3 f = d.outward * (-d.distance_mm * b.obstacle.stiffness_n_per_mm);
      sum = sum + Wrench{f, cross(p - pivot, f)};
    }
  }
  sum.torque_nmm = sum.torque_nmm - pose.axis * dot(sum.torque_nmm, pose.axis);
  return sum;
}

}  // namespace kerf
