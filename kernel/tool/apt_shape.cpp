// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "kernel/tool/outline.h"
#include "kernel/tool/tool_check.h"

namespace kerf {
namespace {

using enum ToolErrorCode;

/// A line of the outline in the half-plane (r, h), directed along the outline.
struct Line {
  ProfilePoint point;
  double dr, dh;  ///< unit direction
  ProfilePoint at(double t) const { return {point.r_mm + t * dr, point.h_mm + t * dh}; }
};

/// Intersects a line with the corner circle. Returns the tangent point, or the point where the line
/// enters or leaves the circle, or nothing if it misses the circle.
std::optional<ProfilePoint> meet(const Line& line, const AptShape& s, bool where_it_leaves) {
  const double cr = s.e_mm - line.point.r_mm, ch = s.f_mm - line.point.h_mm;
  const double foot = cr * line.dr + ch * line.dh;
  const double miss = std::abs(line.dr * ch - line.dh * cr) - s.r_mm;
  if (miss > kMissAllowanceMm) return std::nullopt;
  const ProfilePoint near = line.at(foot);
  if (std::abs(miss) <= kOutlineEpsilonMm) return near;
  if (miss > 0) {
    const double scale = s.r_mm / (s.r_mm + miss);
    return ProfilePoint{s.e_mm + (near.r_mm - s.e_mm) * scale,
                        s.f_mm + (near.h_mm - s.f_mm) * scale};
  }
  const double half = std::sqrt(-miss * (2 * s.r_mm + miss));
  return line.at(where_it_leaves ? foot + half : foot - half);
}

ToolCheck check_fields(const AptShape& s) {
  if (auto c = check_length("d_mm", s.d_mm); !c) return c;
  if (auto c = check_coordinate("r_mm", s.r_mm, 0); !c) return c;
  if (auto c = check_coordinate("e_mm", s.e_mm, -kToolLengthMaxMm); !c) return c;
  if (auto c = check_coordinate("f_mm", s.f_mm, -kToolLengthMaxMm); !c) return c;
  if (s.alpha_deg != 0) {
    if (auto c = check_angle("alpha_deg", s.alpha_deg, 0, 90); !c) return c;
  }
  if (auto c = check_angle("beta_deg", s.beta_deg, -90, 90); !c) return c;
  return check_length("h_mm", s.h_mm);
}

/// Returns the pieces of `outline` continued by the side line. `from` is the end of the arc, or of
/// the bottom line for a sharp corner.
Pieces with_side(std::vector<OutlineSection> outline, ProfilePoint from, const Line& side,
                 double h_mm) {
  if (h_mm - from.h_mm > kOutlineEpsilonMm) {
    double r = side.point.r_mm;
    if (side.dr != 0) r += (h_mm - side.point.h_mm) * (side.dr / side.dh);
    if (r < -kOutlineEpsilonMm) {
      return reject(kInconsistent, "beta_deg", "makes the side line cross the axis below h_mm");
    }
    if (r > kToolLengthMaxMm) {
      return reject(kOutOfRange, "beta_deg", "makes the upper radius larger than 5000 mm");
    }
    outline.emplace_back(OutlineLine{from, {std::max(r, 0.0), h_mm}});
  }
  return pieces_of(outline);
}

Pieces sharp_corner(const AptShape& s, const Line& side) {
  if (std::abs(s.e_mm - side.point.r_mm) > kMissAllowanceMm) {
    return reject(kInconsistent, "e_mm", "must be d_mm / 2 if r_mm is 0");
  }
  if (std::abs(s.f_mm - side.point.h_mm) > kMissAllowanceMm) {
    return reject(kInconsistent, "f_mm", "must be d_mm / 2 tan(alpha_deg) if r_mm is 0");
  }
  if (s.h_mm < side.point.h_mm) {
    return reject(kTooShort, "h_mm",
                  "must be at least the height of the corner between bottom and side line");
  }
  return with_side({OutlineLine{{0, 0}, side.point}}, side.point, side, s.h_mm);
}

}  // namespace

Pieces resolve(const AptShape& s) {
  if (auto c = check_fields(s); !c) return std::unexpected(c.error());
  const double alpha = radians(s.alpha_deg), beta = radians(s.beta_deg);
  const Line bottom{{0, 0}, std::cos(alpha), std::sin(alpha)};
  const Line side{{s.d_mm / 2, s.d_mm / 2 * std::tan(alpha)}, std::sin(beta), std::cos(beta)};
  if (s.r_mm == 0) return sharp_corner(s, side);

  const auto start = meet(bottom, s, true), end = meet(side, s, false);
  if (!start) return reject(kInconsistent, "f_mm", "makes the corner arc miss the bottom line");
  if (!end) return reject(kInconsistent, "d_mm", "makes the side line miss the corner arc");
  if (start->r_mm < -kOutlineEpsilonMm || start->h_mm < -kOutlineEpsilonMm) {
    return reject(kInconsistent, "f_mm", "makes the corner arc reach below the tip");
  }
  if (start->r_mm < s.e_mm - kOutlineEpsilonMm || end->r_mm < s.e_mm - kOutlineEpsilonMm ||
      end->h_mm < start->h_mm - kOutlineEpsilonMm) {
    return reject(kInconsistent, "e_mm", "leaves no arc between the bottom line and the side line");
  }
  if (s.h_mm <= start->h_mm)
    return reject(kTooShort, "h_mm",
                  "must be greater than the height of the lower end of the corner arc");
  const ProfilePoint from{std::max(start->r_mm, 0.0), std::max(start->h_mm, 0.0)};
  ProfilePoint to = *end;
  if (s.h_mm < to.h_mm) {
    // The cutter ends within the arc.
    const double above = s.h_mm - s.f_mm;
    to = {s.e_mm + std::sqrt(std::max(0.0, s.r_mm * s.r_mm - above * above)), s.h_mm};
  }
  return with_side({OutlineLine{{0, 0}, from}, OutlineArc{from, to, {s.e_mm, s.f_mm}, s.r_mm}}, to,
                   side, s.h_mm);
}

}  // namespace kerf
