// SPDX-License-Identifier: Apache-2.0
#include "server/formats/arc_fit.h"

#include <cmath>

#include "server/formats/control/arc.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr std::size_t kPosesMin = 4;
/// Radius range of arcs, mm. Smaller ones are not worth an arc, larger ones not exact enough.
constexpr double kRadiusMinMm = 0.05, kRadiusMaxMm = 5000;
/// The largest angle between neighbors, degrees. Polygons with wider steps are intended.
constexpr double kStepMaxDeg = 46;

struct Planar {
  double x, y;
};

// The center of the circle through three points, or nullopt on a line.
std::optional<Planar> circumcenter(PlanePoint a, PlanePoint b, PlanePoint c) {
  const double bx = b.first - a.first, by = b.second - a.second;
  const double cx = c.first - a.first, cy = c.second - a.second;
  const double twice_area = 2 * (bx * cy - by * cx);
  const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  if (std::abs(twice_area) < 1e-9 * (b2 + c2)) return std::nullopt;
  return Planar{a.first + (cy * b2 - by * c2) / twice_area,
                a.second + (bx * c2 - cx * b2) / twice_area};
}

// Whether a path stays within the tolerance of a circle, and turns in one direction by less than
// the limit.
class Trial {
 public:
  Trial(std::span<const ToolPose> path, ArcPlane plane, double tolerance_mm)
      : path_(path), plane_(plane), tolerance_mm_(tolerance_mm) {}

  std::optional<FittedArc> run() {
    const PlanePoint first = at(0), middle = at(path_.size() / 2), last = at(path_.size() - 1);
    const auto center = circumcenter(first, middle, last);
    if (!center) return std::nullopt;
    center_ = *center;
    radius_ = std::hypot(first.first - center_.x, first.second - center_.y);
    if (radius_ < kRadiusMinMm || radius_ > kRadiusMaxMm) return std::nullopt;
    if (!turns_in_one_direction()) return std::nullopt;
    const double rise = last.normal - first.normal;
    if (!rises_evenly(rise)) return std::nullopt;
    return FittedArc{.plane = plane_,
                     .center = {center_.x, center_.y, 0},
                     .counterclockwise = sweep_ > 0,
                     .helical = std::abs(rise) > 0};
  }

 private:
  PlanePoint at(std::size_t i) const { return in_plane(path_[i].tip_mm, plane_); }

  double angle_of(PlanePoint p) const {
    return std::atan2(p.second - center_.y, p.first - center_.x);
  }

  bool is_near(PlanePoint p) const {
    const double r = std::hypot(p.first - center_.x, p.second - center_.y);
    return std::abs(r - radius_) <= tolerance_mm_;
  }

  bool turns_in_one_direction() {
    double before = angle_of(at(0));
    for (std::size_t i = 1; i < path_.size(); ++i) {
      const PlanePoint a = at(i - 1), b = at(i);
      const PlanePoint middle{(a.first + b.first) / 2, (a.second + b.second) / 2, 0};
      if (!is_near(b) || !is_near(middle)) return false;
      const double angle = angle_of(b);
      const double step = std::remainder(angle - before, 360 * kRadPerDeg);
      if (step == 0 || (sweep_ != 0 && (step > 0) != (sweep_ > 0))) return false;
      if (std::abs(step) > kStepMaxDeg * kRadPerDeg) return false;
      sweep_ += step;
      before = angle;
    }
    return std::abs(sweep_) <= kArcSweepMaxDeg * kRadPerDeg;
  }

  bool rises_evenly(double rise) const {
    const double first = at(0).normal;
    double turned = 0, before = angle_of(at(0));
    for (std::size_t i = 1; i < path_.size(); ++i) {
      const double angle = angle_of(at(i));
      turned += std::remainder(angle - before, 360 * kRadPerDeg);
      before = angle;
      if (std::abs(at(i).normal - first - rise * turned / sweep_) > tolerance_mm_) return false;
    }
    return true;
  }

  std::span<const ToolPose> path_;
  ArcPlane plane_;
  double tolerance_mm_;
  Planar center_{};
  double radius_ = 0, sweep_ = 0;
};

}  // namespace

std::optional<FittedArc> fit_arc(std::span<const ToolPose> path, double tolerance_mm) {
  if (path.size() < kPosesMin) return std::nullopt;
  for (const ToolPose& pose : path)
    if (!(pose.axis == path.front().axis)) return std::nullopt;
  for (const ArcPlane plane : {ArcPlane::kXy, ArcPlane::kZx, ArcPlane::kYz})
    if (const auto arc = Trial(path, plane, tolerance_mm).run()) return arc;
  return std::nullopt;
}

FittedArc with_equal_radii(const FittedArc& arc, Vec3 from, Vec3 to) {
  const PlanePoint a = in_plane(from, arc.plane), b = in_plane(to, arc.plane);
  const double dx = b.first - a.first, dy = b.second - a.second;
  const double x = (a.first + b.first) / 2, y = (a.second + b.second) / 2;
  const double height =
      ((arc.center.second - y) * dx - (arc.center.first - x) * dy) / (dx * dx + dy * dy);
  FittedArc result = arc;
  result.center.first = x - height * dy;
  result.center.second = y + height * dx;
  return result;
}

double arc_length_mm(const FittedArc& arc, Vec3 from, Vec3 to) {
  return arc_about(from, to, arc.plane, arc.center, arc.counterclockwise ? 1 : -1).length_mm();
}

}  // namespace kerf
