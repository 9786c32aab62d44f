// SPDX-License-Identifier: Apache-2.0
#include "kernel/tool/convex_part.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Greatest cosine of the angle between the outline's directions on both sides of a ridge.
constexpr double kRidgeCos = 0.9;

/// A point of an outline, or a direction along it.
struct OutlinePoint {
  double h, r;
};
OutlinePoint operator-(OutlinePoint a, OutlinePoint b) { return {a.h - b.h, a.r - b.r}; }
double length(OutlinePoint d) { return std::sqrt(d.h * d.h + d.r * d.r); }
/// Positive if `b` turns away from the axis relative to `a`.
double cross(OutlinePoint a, OutlinePoint b) { return a.h * b.r - a.r * b.h; }
double dot(OutlinePoint a, OutlinePoint b) { return a.h * b.h + a.r * b.r; }
OutlinePoint unit(OutlinePoint d) { return {d.h / length(d), d.r / length(d)}; }

OutlinePoint lower_end(const ToolPiece& piece) {
  const double h = extent(piece).z0_mm;
  return {h, radius_at(piece, h)};
}
OutlinePoint upper_end(const ToolPiece& piece) {
  const double h = extent(piece).z1_mm;
  return {h, radius_at(piece, h)};
}

/// Returns the unit direction of a piece's outline, upwards, at one of its ends.
OutlinePoint direction_at(const ToolPiece& piece, OutlinePoint end) {
  if (const auto* arc = std::get_if<ArcPiece>(&piece)) {
    const double along = end.h - arc->center_z_mm;
    return unit({half_chord(arc->radius_mm, along), -along});
  }
  return unit(upper_end(piece) - lower_end(piece));
}

double reach_of(const ToolPiece& piece) { return length(upper_end(piece) - lower_end(piece)); }

bool is_near(double a, double b, double epsilon) { return std::abs(a - b) <= epsilon; }

bool is_same_circle(const ArcPiece& a, const ArcPiece& b) {
  return is_near(a.center_r_mm, b.center_r_mm, kStraightMm) &&
         is_near(a.center_z_mm, b.center_z_mm, kStraightMm) &&
         is_near(a.radius_mm, b.radius_mm, kStraightMm);
}

/// Returns a ball as the arc below the height `top`.
ArcPiece arc_of(const BallPiece& ball, double top) {
  return {0, ball.center_mm, ball.radius_mm, ball.center_mm - ball.radius_mm, top};
}

/// Returns the pieces without balls. A ball that the next piece continues ends where that piece
/// begins.
std::vector<ToolPiece> sections_of(std::span<const ToolPiece> pieces) {
  std::vector<ToolPiece> sections;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const auto* ball = std::get_if<BallPiece>(&pieces[i]);
    if (ball == nullptr) {
      sections.push_back(pieces[i]);
      continue;
    }
    double top = extent(*ball).z1_mm;
    if (i + 1 < pieces.size()) {
      const OutlinePoint next = lower_end(pieces[i + 1]);
      const double radius = radius_at(*ball, next.h);
      if (radius > 0 && is_near(radius, next.r, kHullAllowanceMm)) top = next.h;
    }
    sections.emplace_back(arc_of(*ball, top));
  }
  return sections;
}

/// Returns the corners of the concave hull over points of ascending height.
std::vector<OutlinePoint> hull_over(const std::vector<OutlinePoint>& points) {
  std::vector<OutlinePoint> hull;
  for (const OutlinePoint p : points) {
    while (!hull.empty() && hull.back().h >= p.h && hull.back().r < p.r) hull.pop_back();
    if (!hull.empty() && hull.back().h >= p.h) continue;
    while (hull.size() > 1 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) >= 0) {
      hull.pop_back();
    }
    hull.push_back(p);
  }
  return hull;
}

/// Returns the distance of a point from the line through two points.
double off_line(OutlinePoint a, OutlinePoint b, OutlinePoint p) {
  return std::abs(cross(b - a, p - a)) / length(b - a);
}

/// Returns whether no point is below the hull by more than the allowance.
bool is_nearly_concave(const std::vector<OutlinePoint>& points,
                       const std::vector<OutlinePoint>& hull) {
  std::size_t k = 1;
  for (const OutlinePoint p : points) {
    while (k + 1 < hull.size() && hull[k].h < p.h) ++k;
    if (off_line(hull[k - 1], hull[k], p) > kHullAllowanceMm) return false;
  }
  return true;
}

/// Returns a hull without corners that hardly protrude.
std::vector<OutlinePoint> simplified(const std::vector<OutlinePoint>& hull) {
  std::vector<OutlinePoint> kept{hull.front()};
  for (std::size_t from = 0; from + 1 < hull.size();) {
    std::size_t to = from + 1;
    const auto is_straight = [&](std::size_t end) {
      for (std::size_t k = from + 1; k < end; ++k) {
        if (off_line(hull[from], hull[end], hull[k]) > kStraightMm) return false;
      }
      return true;
    };
    while (to + 1 < hull.size() && is_straight(to + 1)) ++to;
    kept.push_back(hull[to]);
    from = to;
  }
  return kept;
}

/// A convex part that grows upwards.
class GrowingPart {
 public:
  /// Adds a section, or returns false if the union would not be convex. The first one always fits.
  bool add(const ToolPiece& section) {
    if (!is_empty()) {
      const OutlinePoint top = straight_.empty() ? upper_end(pieces_.back()) : straight_.back();
      const OutlinePoint from = lower_end(section);
      if (!is_near(top.h, from.h, kHullAllowanceMm) || !is_near(top.r, from.r, kHullAllowanceMm))
        return false;
    }
    const auto* arc = std::get_if<ArcPiece>(&section);
    return arc != nullptr ? add_arc(*arc) : add_straight(section);
  }

  /// Completes the part and returns it.
  ConvexPart finish() {
    end_straight();
    ConvexPart part;
    for (std::size_t k = 1; k < pieces_.size(); ++k) {
      const OutlinePoint joint = lower_end(pieces_[k]);
      const OutlinePoint below = direction_at(pieces_[k - 1], joint);
      if (dot(below, direction_at(pieces_[k], joint)) < kRidgeCos)
        part.ridges_mm.push_back(joint.h);
    }
    part.pieces = std::move(pieces_);
    return part;
  }

 private:
  bool is_empty() const { return pieces_.empty() && straight_.empty(); }

  /// Returns whether the outline bends towards the axis, or hardly away, from one piece to the
  /// next. Beyond its end, one piece is continued along the other.
  static bool is_convex(const ToolPiece& below, const ToolPiece& above) {
    const double away =
        cross(direction_at(below, upper_end(below)), direction_at(above, lower_end(above)));
    return away * std::max(reach_of(below), reach_of(above)) <= kHullAllowanceMm;
  }

  bool add_arc(const ArcPiece& arc) {
    if (straight_.empty() && !pieces_.empty()) {
      auto* last = std::get_if<ArcPiece>(&pieces_.back());
      if (last != nullptr && is_same_circle(*last, arc)) {
        last->z1_mm = arc.z1_mm;
        last->radius_mm =
            std::max({last->radius_mm, arc.radius_mm, std::abs(arc.z1_mm - last->center_z_mm)});
        return true;
      }
      if (!is_convex(pieces_.back(), arc)) return false;
    }
    if (!straight_.empty() && !is_convex(frusta_of(hull_over(straight_)).back(), arc)) return false;
    end_straight();
    pieces_.emplace_back(arc);
    return true;
  }

  bool add_straight(const ToolPiece& section) {
    std::vector<OutlinePoint> points = straight_;
    points.push_back(lower_end(section));
    points.push_back(upper_end(section));
    const std::vector<OutlinePoint> hull = hull_over(points);
    if (!is_nearly_concave(points, hull)) return false;
    if (!pieces_.empty() && !is_convex(pieces_.back(), frusta_of(hull).front())) return false;
    straight_ = std::move(points);
    return true;
  }

  static std::vector<ToolPiece> frusta_of(const std::vector<OutlinePoint>& corners) {
    std::vector<ToolPiece> frusta;
    for (std::size_t k = 1; k < corners.size(); ++k) {
      const OutlinePoint a = corners[k - 1], b = corners[k];
      frusta.emplace_back(FrustumPiece{a.h, a.r, b.h, b.r});
    }
    return frusta;
  }

  void end_straight() {
    if (straight_.empty()) return;
    for (const ToolPiece& frustum : frusta_of(simplified(hull_over(straight_)))) {
      pieces_.push_back(frustum);
    }
    straight_.clear();
  }

  std::vector<ToolPiece> pieces_;       ///< finished
  std::vector<OutlinePoint> straight_;  ///< ends of the straight sections above them
};

/// Returns whether a part's lower disc is within the part below.
bool is_covered(const ConvexPart& below, const ConvexPart& part) {
  const OutlinePoint bottom = lower_end(part.pieces.front());
  const Extent e = extent(below);
  if (!(e.z0_mm < bottom.h) || bottom.h > e.z1_mm + kHullAllowanceMm) return false;
  return radius_at(below, std::min(bottom.h, e.z1_mm)) >= bottom.r - kHullAllowanceMm;
}

}  // namespace

std::vector<ConvexPart> convex_parts(std::span<const ToolPiece> pieces) {
  std::vector<ConvexPart> parts;
  GrowingPart part;
  const std::vector<ToolPiece> sections = sections_of(pieces);
  for (const ToolPiece& section : sections) {
    if (part.add(section)) continue;
    parts.push_back(part.finish());
    part = {};
    part.add(section);
  }
  if (!sections.empty()) parts.push_back(part.finish());
  for (std::size_t k = 1; k < parts.size(); ++k) {
    parts[k].covered = is_covered(parts[k - 1], parts[k]);
  }
  return parts;
}

Extent extent(const ConvexPart& part) {
  Extent whole = extent(part.pieces.front());
  for (const ToolPiece& piece : part.pieces) {
    const Extent e = extent(piece);
    whole = {whole.z0_mm, e.z1_mm, std::max(whole.radius_mm, e.radius_mm)};
  }
  return whole;
}

const ToolPiece& piece_at(const ConvexPart& part, double z_mm) {
  std::size_t k = part.pieces.size() - 1;
  while (k > 0 && extent(part.pieces[k]).z0_mm > z_mm) --k;
  return part.pieces[k];
}

double radius_at(const ConvexPart& part, double z_mm) {
  double radius = kNoRadiusMm;
  for (const ToolPiece& piece : part.pieces) radius = std::max(radius, radius_at(piece, z_mm));
  return radius;
}

}  // namespace kerf
