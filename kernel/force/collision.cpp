// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/collision.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "kernel/force/body_contact.h"
#include "kernel/force/obstacle_patch.h"
#include "kernel/force/signed_distance.h"
#include "kernel/force/triangle_tree.h"
#include "kernel/math/rotation.h"
#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// A disc of the tool, normal to its axis.
struct Disc {
  Vec3 center, axis;
  double radius;
};

constexpr int kHeightSteps = 20;  ///< each keeps two thirds of the interval of heights
constexpr int kDescentSteps = 3;
constexpr int kLineSteps = 10;

/// Returns the point of least distance on the segment from p to q. It is the global minimum for
/// convex obstacles, a local one for meshes.
Vec3 lowest_between(const Obstacle& obstacle, Vec3 p, Vec3 q) {
  double lo = 0, hi = 1;
  const auto at = [&](double t) { return signed_distance(obstacle, p + (q - p) * t).distance_mm; };
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
    const SignedDistance here = signed_distance(obstacle, p);
    const Vec3 across = here.outward - disc.axis * dot(here.outward, disc.axis);
    if (across == Vec3{}) break;
    const Vec3 q = lowest_between(obstacle, p, disc.center - normalized(across) * disc.radius);
    if (!(signed_distance(obstacle, q).distance_mm < here.distance_mm)) break;
    p = q;
  }
  return p;
}

/// Returns the deepest point of a convex body of revolution by ternary search over its discs, since
/// the least distance of a disc is a convex function of its height. Of equally deep points, returns
/// the lowest.
Vec3 deepest_of_discs(const ToolPiece& piece, const ToolPose& pose, const Obstacle& obstacle) {
  const auto point = [&](double z) {
    return deepest_of_disc({pose.tip_mm + pose.axis * z, pose.axis, radius_at(piece, z)}, obstacle);
  };
  const auto depth = [&](double z) { return signed_distance(obstacle, point(z)).distance_mm; };
  const Extent whole = extent(piece);
  double lo = whole.z0_mm, hi = whole.z1_mm;
  double best_z = lo, best = depth(lo);
  const auto consider = [&](double z) {
    const double d = depth(z);
    if (d < best - kDepthEpsilonMm) {
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
  const auto* arc = std::get_if<ArcPiece>(&piece);
  if (arc != nullptr && arc->center_r_mm == 0) {
    // The deepest point of the whole ball; the arc may be a part of it.
    const Vec3 center = pose.tip_mm + pose.axis * arc->center_z_mm;
    const Vec3 p = center - signed_distance(obstacle, center).outward * arc->radius_mm;
    const double z = dot(p - pose.tip_mm, pose.axis);
    if (z >= arc->z0_mm - kDepthEpsilonMm && z <= arc->z1_mm + kDepthEpsilonMm) return p;
  }
  return deepest_of_discs(piece, pose, obstacle);
}

/// A point of a tool, and its distance from an obstacle.
struct Nearest {
  Vec3 point;
  SignedDistance at;
};

/// Returns the deepest point of a part, or nothing if it is farther away than `reach_mm`. Of
/// equally deep points, returns the lowest.
std::optional<Nearest> deepest_of(const ConvexPart& part, const ToolPose& pose,
                                  const Obstacle& obstacle, double reach_mm) {
  std::optional<Nearest> best;
  for (const ToolPiece& piece : part.pieces) {
    const Extent e = extent(piece);
    const double half = (e.z1_mm - e.z0_mm) / 2;
    const Vec3 middle = pose.tip_mm + pose.axis * (e.z0_mm + half);
    const double bound = std::sqrt(half * half + e.radius_mm * e.radius_mm);
    // The distances of two points differ by no more than the distance between them.
    if (signed_distance(obstacle, middle).distance_mm - bound > reach_mm) continue;
    const Vec3 p = deepest_point(piece, pose, obstacle);
    const SignedDistance at = signed_distance(obstacle, p);
    if (!(at.distance_mm < (best ? reach_mm - kDepthEpsilonMm : reach_mm))) continue;
    best = {p, at};
    reach_mm = at.distance_mm;
  }
  return best;
}

/// Distance to either side of a point within which an obstacle's normal changes at a crease, and
/// the greatest cosine of the change.
constexpr double kCreaseMm = 0.05;
constexpr double kCreaseCos = 0.9;
/// A deepest point within this share of a disc's radius belongs to the disc, otherwise to its rim:
/// the search finds points of the rim to a few hundredths of the radius.
constexpr double kDiscShare = 0.9;

/// The surface of a part at a point: smooth, with a normal into the part, or an edge across the
/// axis.
struct SurfaceAt {
  bool edge = false;
  Vec3 inward;
  Vec3 tangents[2];  ///< of the surface; the first one is along the edge
};

SurfaceAt surface_at(const ConvexPart& part, const ToolPose& pose, Vec3 p) {
  const double z = dot(p - pose.tip_mm, pose.axis);
  const Vec3 across = p - pose.tip_mm - pose.axis * z;
  const double r = length(across);
  const Vec3 radial = r > 0 ? across * (1 / r) : any_perpendicular(pose.axis);
  const Vec3 around = cross(pose.axis, radial);
  const auto is_near = [z](double edge_mm) { return std::abs(z - edge_mm) < kCreaseMm; };
  const Extent whole = extent(part);
  const bool bottom = is_near(whole.z0_mm), top = is_near(whole.z1_mm);
  if (bottom || top) {
    // Both ends of a thin part may be near. The point belongs to the nearer one.
    const bool lower = z - whole.z0_mm <= whole.z1_mm - z;
    const double end_mm = lower ? whole.z0_mm : whole.z1_mm;
    const Vec3 inward = lower ? pose.axis : -pose.axis;
    if (r < kDiscShare * radius_at(part, end_mm)) return {false, inward, {around, radial}};
  }
  const auto* first = std::get_if<ArcPiece>(&part.pieces.front());
  const auto* last = std::get_if<ArcPiece>(&part.pieces.back());
  const bool rim = (bottom && (first == nullptr || !is_level_below(*first))) ||
                   (top && (last == nullptr || !is_level_above(*last)));
  if (rim || std::ranges::any_of(part.ridges_mm, is_near)) return {true, {}, {around, {}}};
  const ToolPiece& piece = piece_at(part, z);
  Vec3 outward = radial - pose.axis * slope_at(piece, z);
  if (const auto* arc = std::get_if<ArcPiece>(&piece)) {
    outward = radial * std::max(0.0, r - arc->center_r_mm) + pose.axis * (z - arc->center_z_mm);
  }
  const Vec3 inward = -normalized(outward);
  return {false, inward, {around, cross(inward, around)}};
}

/// Returns the direction in which an obstacle pushes a part at its deepest point `p`. If two faces
/// of the obstacle are equally near, the least motion changes which one is nearer. But at the
/// deepest point of a smooth surface, a weighted mean of both normals is along the surface's own
/// normal, and at that of an edge, one is perpendicular to the edge.
Vec3 push_direction(const ConvexPart& part, const ToolPose& pose, const Obstacle& obstacle, Vec3 p,
                    Vec3 outward) {
  const SurfaceAt surface = surface_at(part, pose, p);
  const auto normals = [&](Vec3 along) {
    const Vec3 step = along * kCreaseMm;
    return std::pair(signed_distance(obstacle, p - step).outward,
                     signed_distance(obstacle, p + step).outward);
  };
  const auto [behind, ahead] = normals(surface.tangents[0]);
  bool crease = dot(behind, ahead) < kCreaseCos;
  Vec3 direction = surface.inward;
  if (surface.edge) {
    const double back = dot(behind, surface.tangents[0]), on = dot(ahead, surface.tangents[0]);
    crease = crease && back < 0 && on > 0;
    direction = behind * on - ahead * back;
  } else if (!crease) {
    const auto [left, right] = normals(surface.tangents[1]);
    crease = dot(left, right) < kCreaseCos;
  }
  return crease && dot(direction, outward) > 0 ? normalized(direction) : outward;
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
  if (m.triangles.size() > kObstacleTrianglesMax) return "mesh may have at most 200000 triangles";
  for (const auto& t : m.triangles) {
    for (const Vec3& v : t) {
      if (!is_finite(v)) return "mesh must be finite";
    }
  }
  return {};
}

/// Returns the contact plane of a part with an obstacle, or nothing if it is farther away than
/// `reach_mm`.
std::optional<ContactPlane> plane_of(const ConvexPart& part, const ToolPose& pose,
                                     const Obstacle& obstacle, double reach_mm) {
  const auto found = deepest_of(part, pose, obstacle, reach_mm);
  if (!found) return {};
  const auto& [p, at] = *found;
  const Vec3 normal =
      at.distance_mm < 0 ? push_direction(part, pose, obstacle, p, at.outward) : at.outward;
  ContactPlane plane{
      p, normal, -at.distance_mm, obstacle.stiffness_n_per_mm, 2 * kContactReachMm, false};
  if (plane.depth_mm > 0) obstacle_patch(part, pose, obstacle, p).place(plane);
  return plane;
}

/// Calls visit(planes) for each obstacle with the planes of the parts that are nearer than
/// `reach_mm`.
template <typename Bounded, typename Visit>
void each_obstacle(const std::vector<Bounded>& obstacles, const Tool& tool, const ToolPose& pose,
                   double reach_mm, Visit visit) {
  const Vec3 tool_middle = pose.tip_mm + pose.axis * (tool.whole_length_mm / 2);
  const double tool_radius = tool.whole_length_mm / 2 + tool.whole_radius_mm + reach_mm;
  for (const Bounded& b : obstacles) {
    if (length(tool_middle - b.center_mm) > tool_radius + b.radius_mm) continue;
    BodyContact contact;
    for (const ConvexPart& part : tool.whole_parts) {
      if (const auto plane = plane_of(part, pose, b.obstacle, reach_mm)) contact.add(*plane);
    }
    visit(contact.shared());
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
    if (auto* mesh = std::get_if<MeshObstacle>(&obstacles_.back().obstacle.shape))
      mesh->tree = make_triangle_tree(mesh->triangles);
  }
}

Wrench Obstacles::push(const Tool& tool, const ToolPose& pose, double pivot_mm) const {
  Wrench sum;
  each_obstacle(obstacles_, tool, pose, 0, [&](std::span<const ContactPlane> planes) {
    sum = sum + wrench_of(planes, pose, pivot_mm);
  });
  return sum;
}

void Obstacles::planes(const Tool& tool, const ToolPose& pose,
                       std::vector<ContactPlane>& out) const {
  each_obstacle(obstacles_, tool, pose, kContactReachMm, [&](std::span<const ContactPlane> planes) {
    out.insert(out.end(), planes.begin(), planes.end());
  });
}

}  // namespace kerf
