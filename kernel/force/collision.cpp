// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/collision.h"

#include <algorithm>
#include <cmath>

#include "kernel/force/obstacle_patch.h"
#include "kernel/force/signed_distance.h"

namespace kerf {
namespace {

SignedDistance distance(const Obstacle& obstacle, Vec3 p) {
  return std::visit([&](const auto& shape) { return signed_distance(shape, p); }, obstacle.shape);
}

/// A disc of the tool, normal to its axis.
struct Disc {
  Vec3 center, axis;
  double radius;
};

constexpr int kHeightSteps = 20;  ///< each keeps two thirds of the interval of heights
constexpr int kDescentSteps = 3;
constexpr int kLineSteps = 10;

/// Returns the point of least distance on the segment from p to q: the global minimum for convex
/// obstacles, a local one for meshes.
Vec3 lowest_between(const Obstacle& obstacle, Vec3 p, Vec3 q) {
  double lo = 0, hi = 1;
  const auto at = [&](double t) { return distance(obstacle, p + (q - p) * t).distance_mm; };
  for (int i = 0; i < kLineSteps; ++i) {
    const double a = lo + (hi - lo) / 3, b = hi - (hi - lo) / 3;
    if (at(a) <= at(b)) {
      hi = b;
    } else {
      lo = a;
    }
  }
  const double middle = (lo + hi) / 2;
  return at(1) <= at(middle) ? q : p + (q - p) * middle;
}

/// Returns the deepest point of a disc, by the conditional gradient method (M. Frank and P. Wolfe,
/// An Algorithm for Quadratic Programming, 1956).
Vec3 deepest_of_disc(const Disc& disc, const Obstacle& obstacle) {
  Vec3 p = disc.center;
  for (int i = 0; i < kDescentSteps; ++i) {
    const SignedDistance here = distance(obstacle, p);
    const Vec3 across = here.outward - disc.axis * dot(here.outward, disc.axis);
    if (across == Vec3{}) break;
    const Vec3 q = lowest_between(obstacle, p, disc.center - normalized(across) * disc.radius);
    if (!(distance(obstacle, q).distance_mm < here.distance_mm)) break;
    p = q;
  }
  return p;
}

/// Returns the deepest point of a convex body of revolution by ternary search over its discs: the
/// least distance of a disc is a convex function of its height.
Vec3 deepest_of_discs(const ToolPiece& piece, const ToolPose& pose, const Obstacle& obstacle) {
  const auto point = [&](double z) {
    return deepest_of_disc({pose.tip_mm + pose.axis * z, pose.axis, radius_at(piece, z)}, obstacle);
  };
  const auto depth = [&](double z) { return distance(obstacle, point(z)).distance_mm; };
  const Extent whole = extent(piece);
  double lo = whole.z0_mm, hi = whole.z1_mm;
  double best_z = lo, best = depth(lo);
  const auto consider = [&](double z) {
    const double d = depth(z);
    if (d < best) {
      best = d;
      best_z = z;
    }
    return d;
  };
  consider(hi);
  for (int i = 0; i < kHeightSteps; ++i) {
    const double a = lo + (hi - lo) / 3, b = hi - (hi - lo) / 3;
    if (consider(a) <= consider(b)) {
      hi = b;
    } else {
      lo = a;
    }
  }
  return point(best_z);
}

Vec3 deepest_point(const ToolPiece& piece, const ToolPose& pose, const Obstacle& obstacle) {
  if (const auto* ball = std::get_if<BallPiece>(&piece)) {
    const Vec3 center = pose.tip_mm + pose.axis * ball->center_mm;
    return center - distance(obstacle, center).outward * ball->radius_mm;
  }
  return deepest_of_discs(piece, pose, obstacle);
}

/// Distance on both sides of a point within which an obstacle's normal changes at a crease, and the
/// greatest cosine of the change.
constexpr double kCreaseMm = 0.05;
constexpr double kCreaseCos = 0.9;

/// Returns the direction in which an obstacle pushes a piece at its deepest point `p`. Where two
/// faces of the obstacle are equally near, the nearer one changes with the least motion. But at the
/// deepest point of a smooth surface, a weighted mean of both normals is along the surface's own.
Vec3 push_direction(const ToolPiece& piece, const ToolPose& pose, const Obstacle& obstacle, Vec3 p,
                    Vec3 outward) {
  const double z = dot(p - pose.tip_mm, pose.axis);
  const Vec3 across = p - pose.tip_mm - pose.axis * z;
  const Extent whole = extent(piece);
  const bool at_rim = z < whole.z0_mm + kCreaseMm || z > whole.z1_mm - kCreaseMm;
  if (at_rim || std::holds_alternative<BallPiece>(piece) || across == Vec3{}) return outward;
  const Vec3 radial = normalized(across);
  const double slope =
      (radius_at(piece, z + kCreaseMm) - radius_at(piece, z - kCreaseMm)) / (2 * kCreaseMm);
  const auto is_crease = [&](Vec3 along) {
    const Vec3 step = normalized(along) * kCreaseMm;
    return dot(distance(obstacle, p + step).outward, distance(obstacle, p - step).outward) <
           kCreaseCos;
  };
  if (!is_crease(pose.axis + radial * slope) && !is_crease(cross(pose.axis, radial)))
    return outward;
  const Vec3 inward = normalized(pose.axis * slope - radial);
  return dot(inward, outward) > 0 ? inward : outward;
}

/// Greatest number of triangles of a mesh. Every query visits all of them, and each piece of a
/// nearby tool makes about a thousand queries.
constexpr std::size_t kMeshTrianglesMax = 1000;

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
  if (!is_finite(b.min_mm) || !is_finite(b.max_mm)) return "box must be finite";
  if (!(b.min_mm.x < b.max_mm.x && b.min_mm.y < b.max_mm.y && b.min_mm.z < b.max_mm.z)) {
    return "box is empty: min_mm must be less than max_mm";
  }
  return {};
}
std::string check_shape(const CylinderObstacle& c) {
  if (!is_finite(c.from_mm) || !is_finite(c.to_mm)) return "cylinder must be finite";
  if (!is_positive(c.radius_mm)) return "cylinder radius_mm must be > 0";
  if (c.from_mm == c.to_mm) return "cylinder has no length: from_mm equals to_mm";
  return {};
}
std::string check_shape(const SphereObstacle& s) {
  if (!is_finite(s.center_mm)) return "sphere must be finite";
  return is_positive(s.radius_mm) ? "" : "sphere radius_mm must be > 0";
}
std::string check_shape(const MeshObstacle& m) {
  if (m.triangles.empty()) return "mesh must have at least one triangle";
  if (m.triangles.size() > kMeshTrianglesMax) return "mesh may have at most 1000 triangles";
  for (const auto& t : m.triangles) {
    for (const Vec3& v : t) {
      if (!is_finite(v)) return "mesh must be finite";
    }
  }
  return {};
}

/// Returns the contact plane of a piece with an obstacle.
ContactPlane plane_of(const ToolPiece& piece, const ToolPose& pose, const Obstacle& obstacle) {
  const Vec3 p = deepest_point(piece, pose, obstacle);
  SignedDistance at = distance(obstacle, p);
  if (at.distance_mm < 0) at.outward = push_direction(piece, pose, obstacle, p, at.outward);
  ContactPlane plane{
      p, at.outward, -at.distance_mm, obstacle.stiffness_n_per_mm, 2 * kContactReachMm, false};
  if (plane.depth_mm > 0) obstacle_patch(piece, pose, obstacle, p).place(plane);
  return plane;
}

/// Calls visit(plane) for each piece with each obstacle whose bounding ball is nearer to the tool's
/// than `reach_mm`.
template <typename Bounded, typename Visit>
void each_piece(const std::vector<Bounded>& obstacles, const Tool& tool, const ToolPose& pose,
                double reach_mm, Visit visit) {
  const Vec3 tool_middle = pose.tip_mm + pose.axis * (tool.whole_length_mm / 2);
  const double tool_radius = tool.whole_length_mm / 2 + tool.whole_radius_mm + reach_mm;
  for (const Bounded& b : obstacles) {
    if (length(tool_middle - b.center_mm) > tool_radius + b.radius_mm) continue;
    for (const auto* pieces : {&tool.pieces, &tool.non_cutting}) {
      for (const ToolPiece& piece : *pieces) {
        visit(plane_of(piece, pose, b.obstacle));
      }
    }
  }
}

}  // namespace

std::string check_obstacle(const Obstacle& obstacle) {
  if (!is_positive(obstacle.stiffness_n_per_mm)) {
    return "stiffness_n_per_mm must be > 0";
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
  std::vector<ContactPlane> all;
  each_piece(obstacles_, tool, pose, 0, [&](const ContactPlane& plane) { all.push_back(plane); });
  return wrench_of(all, pose, pivot_mm);
}

void Obstacles::planes(const Tool& tool, const ToolPose& pose,
                       std::vector<ContactPlane>& out) const {
  each_piece(obstacles_, tool, pose, kContactReachMm, [&](const ContactPlane& plane) {
    if (plane.depth_mm > -kContactReachMm) out.push_back(plane);
  });
}

}  // namespace kerf
