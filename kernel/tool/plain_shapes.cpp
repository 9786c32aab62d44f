// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "kernel/tool/tool_check.h"

namespace kerf {
namespace {

ToolError too_short(std::string reason) {
  return {ToolErrorCode::kTooShort, "length_mm", std::move(reason)};
}

}  // namespace

Pieces resolve(const BallShape& s) {
  if (auto c = check_length("diameter_mm", s.diameter_mm); !c) return std::unexpected(c.error());
  if (auto c = check_length("length_mm", s.length_mm); !c) return std::unexpected(c.error());
  const double r = s.diameter_mm / 2;
  if (s.length_mm < r) return std::unexpected(too_short("must be at least half the diameter"));
  std::vector<ToolPiece> pieces{BallPiece{r, r}};
  if (s.length_mm > r) pieces.emplace_back(FrustumPiece{r, r, s.length_mm, r});
  return pieces;
}

Pieces resolve(const FlatShape& s) {
  if (auto c = check_length("diameter_mm", s.diameter_mm); !c) return std::unexpected(c.error());
  if (auto c = check_length("length_mm", s.length_mm); !c) return std::unexpected(c.error());
  const double r = s.diameter_mm / 2;
  return std::vector<ToolPiece>({FrustumPiece{0, r, s.length_mm, r}});
}

Pieces resolve(const BullNoseShape& s) {
  if (auto c = check_length("diameter_mm", s.diameter_mm); !c) return std::unexpected(c.error());
  if (auto c = check_length("length_mm", s.length_mm); !c) return std::unexpected(c.error());
  const double r = s.diameter_mm / 2, corner = s.corner_radius_mm;
  if (corner != 0) {
    if (auto c = check_length("corner_radius_mm", corner); !c) return std::unexpected(c.error());
  }
  if (corner > r) {
    return std::unexpected(ToolError{ToolErrorCode::kOutOfRange, "corner_radius_mm",
                                     "must be at most half the diameter"});
  }
  if (s.length_mm < corner) return std::unexpected(too_short("must be at least corner_radius_mm"));
  if (corner == 0) return resolve(FlatShape{s.diameter_mm, s.length_mm});
  if (corner == r) return resolve(BallShape{s.diameter_mm, s.length_mm});
  std::vector<ToolPiece> pieces{ArcPiece{r - corner, corner, corner, 0, corner}};
  if (s.length_mm > corner) pieces.emplace_back(FrustumPiece{corner, r, s.length_mm, r});
  return pieces;
}

Pieces resolve(const TaperShape& s) {
  if (auto c = check_length("diameter_mm", s.diameter_mm); !c) return std::unexpected(c.error());
  if (auto c = check_length("length_mm", s.length_mm); !c) return std::unexpected(c.error());
  if (auto c = check_angle("half_angle_deg", s.half_angle_deg, 0, 90); !c) {
    return std::unexpected(c.error());
  }
  const double r = s.diameter_mm / 2;
  const double sine = std::sin(radians(s.half_angle_deg));
  const double cosine = std::cos(radians(s.half_angle_deg));
  const double slope = sine / cosine;
  double z0 = 0, r0 = r;
  std::vector<ToolPiece> pieces;
  if (s.tip == TaperTip::kBall) {
    // The side touches the ball where the normal leans down by the half angle.
    pieces.emplace_back(BallPiece{r, r});
    z0 = r * (1 - sine);
    r0 = r * cosine;
    if (s.length_mm <= z0)
      return std::unexpected(too_short("must be greater than the height of the ball tip"));
  }
  const double r1 = r0 + (s.length_mm - z0) * slope;
  if (r1 > kToolLengthMaxMm) {
    return std::unexpected(ToolError{ToolErrorCode::kOutOfRange, "half_angle_deg",
                                     "makes the upper radius larger than 5000 mm"});
  }
  pieces.emplace_back(FrustumPiece{z0, r0, s.length_mm, r1});
  return pieces;
}

Pieces resolve(const ConeEndShape& s) {
  if (auto c = check_length("diameter_mm", s.diameter_mm); !c) return std::unexpected(c.error());
  if (auto c = check_length("length_mm", s.length_mm); !c) return std::unexpected(c.error());
  if (auto c = check_angle("tip_angle_deg", s.tip_angle_deg, 0, 180); !c) {
    return std::unexpected(c.error());
  }
  const double r = s.diameter_mm / 2;
  const double half = radians(s.tip_angle_deg) / 2;
  const double cone = r * std::cos(half) / std::sin(half);
  if (s.length_mm < cone)
    return std::unexpected(too_short("must be at least the height of the cone at the tip"));
  std::vector<ToolPiece> pieces{FrustumPiece{0, 0, cone, r}};
  if (s.length_mm > cone) pieces.emplace_back(FrustumPiece{cone, r, s.length_mm, r});
  return pieces;
}

}  // namespace kerf
