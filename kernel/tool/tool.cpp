#include "kernel/tool/tool.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/tool/outline.h"
#include "kernel/tool/tool_check.h"

namespace kerf {
namespace {

using Pieces = std::expected<std::vector<ToolPiece>, ToolError>;

struct Extent {
  double top_mm, radius_mm;
};

Extent extent(const BallPiece& p) { return {p.center_mm + p.radius_mm, p.radius_mm}; }
Extent extent(const FrustumPiece& p) { return {p.z1_mm, std::max(p.r0_mm, p.r1_mm)}; }
Extent extent(const ArcPiece& p) {
  // Widest at the height of its centre, or at the end that is nearest to it.
  const double off = std::clamp(p.center_z_mm, p.z0_mm, p.z1_mm) - p.center_z_mm;
  return {p.z1_mm, p.center_r_mm + std::sqrt(std::max(0.0, p.radius_mm * p.radius_mm - off * off))};
}

ToolError too_short(std::string reason) {
  return {ToolErrorCode::kTooShort, "length_mm", std::move(reason)};
}

Pieces make(const BallShape& s) {
  if (auto c = check_length("diameter_mm", s.diameter_mm); !c) return std::unexpected(c.error());
  if (auto c = check_length("length_mm", s.length_mm); !c) return std::unexpected(c.error());
  const double r = s.diameter_mm / 2;
  if (s.length_mm < r) return std::unexpected(too_short("must be at least half the diameter"));
  std::vector<ToolPiece> pieces{BallPiece{r, r}};
  if (s.length_mm > r) pieces.emplace_back(FrustumPiece{r, r, s.length_mm, r});
  return pieces;
}

Pieces make(const FlatShape& s) {
  if (auto c = check_length("diameter_mm", s.diameter_mm); !c) return std::unexpected(c.error());
  if (auto c = check_length("length_mm", s.length_mm); !c) return std::unexpected(c.error());
  const double r = s.diameter_mm / 2;
  return std::vector<ToolPiece>({FrustumPiece{0, r, s.length_mm, r}});
}

Pieces make(const BullNoseShape& s) {
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
  if (s.length_mm < corner) return std::unexpected(too_short("ends within the rounded corner"));
  if (corner == 0) return make(FlatShape{s.diameter_mm, s.length_mm});
  if (corner == r) return make(BallShape{s.diameter_mm, s.length_mm});
  std::vector<ToolPiece> pieces{ArcPiece{r - corner, corner, corner, 0, corner}};
  if (s.length_mm > corner) pieces.emplace_back(FrustumPiece{corner, r, s.length_mm, r});
  return pieces;
}

Pieces make(const TaperShape& s) {
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
    if (s.length_mm <= z0) return std::unexpected(too_short("ends within the ball tip"));
  }
  const double r1 = r0 + (s.length_mm - z0) * slope;
  if (r1 > kToolLengthMaxMm) {
    return std::unexpected(ToolError{ToolErrorCode::kOutOfRange, "half_angle_deg",
                                     "makes the upper radius larger than 5000 mm"});
  }
  pieces.emplace_back(FrustumPiece{z0, r0, s.length_mm, r1});
  return pieces;
}

Pieces make(const ConeEndShape& s) {
  if (auto c = check_length("diameter_mm", s.diameter_mm); !c) return std::unexpected(c.error());
  if (auto c = check_length("length_mm", s.length_mm); !c) return std::unexpected(c.error());
  if (auto c = check_angle("tip_angle_deg", s.tip_angle_deg, 0, 180); !c) {
    return std::unexpected(c.error());
  }
  const double r = s.diameter_mm / 2;
  const double half = radians(s.tip_angle_deg) / 2;
  const double cone = r * std::cos(half) / std::sin(half);
  if (s.length_mm < cone) return std::unexpected(too_short("is shorter than the cone at the tip"));
  std::vector<ToolPiece> pieces{FrustumPiece{0, 0, cone, r}};
  if (s.length_mm > cone) pieces.emplace_back(FrustumPiece{cone, r, s.length_mm, r});
  return pieces;
}

Pieces make(const AptShape& s) { return resolve(s); }

std::string check_piece(const BallPiece& p) {
  if (!std::isfinite(p.center_mm) || !std::isfinite(p.radius_mm)) return "is not finite";
  if (p.radius_mm <= 0 || p.radius_mm > kToolLengthMaxMm) return "has a radius out of range";
  if (p.center_mm < 0 || p.center_mm > kToolLengthMaxMm) return "has a centre out of range";
  return {};
}

std::string check_piece(const FrustumPiece& p) {
  if (!std::isfinite(p.z0_mm) || !std::isfinite(p.z1_mm) || !std::isfinite(p.r0_mm) ||
      !std::isfinite(p.r1_mm)) {
    return "is not finite";
  }
  if (p.r0_mm < 0 || p.r1_mm < 0 || (p.r0_mm == 0 && p.r1_mm == 0)) return "has no radius";
  if (p.r0_mm > kToolLengthMaxMm || p.r1_mm > kToolLengthMaxMm) return "has a radius out of range";
  if (p.z0_mm < 0 || p.z1_mm > kToolLengthMaxMm || p.z0_mm >= p.z1_mm) {
    return "has heights out of range or out of order";
  }
  return {};
}

std::string check_piece(const ArcPiece& p) {
  for (const double v : {p.center_r_mm, p.center_z_mm, p.radius_mm, p.z0_mm, p.z1_mm}) {
    if (!std::isfinite(v)) return "is not finite";
    if (std::abs(v) > kToolLengthMaxMm) return "is out of range";
  }
  if (p.radius_mm <= 0) return "has no radius";
  if (p.z0_mm < 0 || p.z0_mm >= p.z1_mm) return "has heights out of range or out of order";
  const double below = p.z0_mm - p.center_z_mm, above = p.z1_mm - p.center_z_mm;
  const double r2 = p.radius_mm * p.radius_mm;
  if (below * below > r2 || above * above > r2) return "has heights beyond its arc";
  // The radius is a concave function of the height, so it is least at an end.
  const double least = p.center_r_mm + std::sqrt(r2 - std::max(below * below, above * above));
  if (least < -kOutlineEpsilonMm) return "has a negative radius";
  return {};
}

ToolCheck check_pieces(const std::vector<ToolPiece>& pieces, const char* field) {
  if (pieces.size() > kToolPiecesMax) {
    return std::unexpected(ToolError{ToolErrorCode::kTooManyPieces, field, "must be at most 1024"});
  }
  for (const ToolPiece& piece : pieces) {
    std::string wrong = std::visit([](const auto& p) { return check_piece(p); }, piece);
    if (!wrong.empty()) {
      return std::unexpected(ToolError{ToolErrorCode::kOutOfRange, field, std::move(wrong)});
    }
  }
  return {};
}

}  // namespace

ToolCheck check_length(const std::string& field, double value_mm) {
  if (!std::isfinite(value_mm)) {
    return std::unexpected(ToolError{ToolErrorCode::kNotFinite, field, "is not a finite number"});
  }
  if (value_mm <= 0) {
    return std::unexpected(
        ToolError{ToolErrorCode::kNotPositive, field, "must be greater than zero"});
  }
  if (value_mm < kToolLengthMinMm || value_mm > kToolLengthMaxMm) {
    return std::unexpected(
        ToolError{ToolErrorCode::kOutOfRange, field, "must be between 0.0001 and 5000 mm"});
  }
  return {};
}

ToolCheck check_coordinate(const std::string& field, double value_mm, double least_mm) {
  if (!std::isfinite(value_mm)) {
    return std::unexpected(ToolError{ToolErrorCode::kNotFinite, field, "is not a finite number"});
  }
  if (value_mm < least_mm || value_mm > kToolLengthMaxMm) {
    return std::unexpected(
        ToolError{ToolErrorCode::kOutOfRange, field,
                  "must be between " + std::to_string(int(least_mm)) + " and 5000 mm"});
  }
  return {};
}

ToolCheck check_angle(const std::string& field, double value_deg, double above_deg,
                      double below_deg) {
  if (!std::isfinite(value_deg)) {
    return std::unexpected(ToolError{ToolErrorCode::kNotFinite, field, "is not a finite number"});
  }
  if (value_deg <= above_deg || value_deg >= below_deg) {
    return std::unexpected(ToolError{ToolErrorCode::kOutOfRange, field,
                                     "must lie strictly between " + std::to_string(int(above_deg)) +
                                         " and " + std::to_string(int(below_deg)) + " degrees"});
  }
  return {};
}

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

Tool assemble(std::vector<ToolPiece> cutting, std::vector<ToolPiece> non_cutting) {
  Tool tool;
  for (const ToolPiece& piece : cutting) {
    const Extent e = std::visit([](const auto& p) { return extent(p); }, piece);
    tool.length_mm = std::max(tool.length_mm, e.top_mm);
    tool.radius_mm = std::max(tool.radius_mm, e.radius_mm);
  }
  tool.whole_length_mm = tool.length_mm;
  tool.whole_radius_mm = tool.radius_mm;
  for (const ToolPiece& piece : non_cutting) {
    const Extent e = std::visit([](const auto& p) { return extent(p); }, piece);
    tool.whole_length_mm = std::max(tool.whole_length_mm, e.top_mm);
    tool.whole_radius_mm = std::max(tool.whole_radius_mm, e.radius_mm);
  }
  tool.pieces = std::move(cutting);
  tool.non_cutting = std::move(non_cutting);
  return tool;
}

std::expected<Tool, ToolError> make_tool(const ToolShape& shape) {
  auto pieces = std::visit([](const auto& s) { return make(s); }, shape);
  if (!pieces) return std::unexpected(pieces.error());
  return make_tool(*std::move(pieces));
}

std::expected<Tool, ToolError> make_tool(std::vector<ToolPiece> cutting,
                                         std::vector<ToolPiece> non_cutting) {
  if (cutting.empty()) {
    return std::unexpected(
        ToolError{ToolErrorCode::kTooShort, "pieces", "must have at least one that cuts"});
  }
  if (auto c = check_pieces(cutting, "pieces"); !c) return std::unexpected(c.error());
  if (auto c = check_pieces(non_cutting, "non_cutting"); !c) return std::unexpected(c.error());
  return assemble(std::move(cutting), std::move(non_cutting));
}

}  // namespace kerf
