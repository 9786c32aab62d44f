#include "kernel/tool/tool.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace kerf {
namespace {

using Check = std::expected<void, ToolError>;

constexpr std::size_t kPiecesMax = 64;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

Check check_length(const char* field, double value_mm) {
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

Check check_angle(const char* field, double value_deg, double max_deg) {
  if (!std::isfinite(value_deg)) {
    return std::unexpected(ToolError{ToolErrorCode::kNotFinite, field, "is not a finite number"});
  }
  if (value_deg <= 0 || value_deg >= max_deg) {
    return std::unexpected(
        ToolError{ToolErrorCode::kOutOfRange, field,
                  "must lie strictly between 0 and " + std::to_string(int(max_deg)) + " degrees"});
  }
  return {};
}

ToolError too_short(std::string reason) {
  return {ToolErrorCode::kTooShort, "length_mm", std::move(reason)};
}

Tool assemble(std::vector<ToolPiece> pieces) {
  Tool tool;
  for (const ToolPiece& piece : pieces) {
    if (const auto* ball = std::get_if<BallPiece>(&piece)) {
      tool.length_mm = std::max(tool.length_mm, ball->center_mm + ball->radius_mm);
      tool.radius_mm = std::max(tool.radius_mm, ball->radius_mm);
    } else if (const auto* arc = std::get_if<ArcPiece>(&piece)) {
      tool.length_mm = std::max(tool.length_mm, arc->z1_mm);
      tool.radius_mm = std::max(tool.radius_mm, arc->center_r_mm + arc->radius_mm);
    } else {
      const auto& frustum = std::get<FrustumPiece>(piece);
      tool.length_mm = std::max(tool.length_mm, frustum.z1_mm);
      tool.radius_mm = std::max({tool.radius_mm, frustum.r0_mm, frustum.r1_mm});
    }
  }
  tool.pieces = std::move(pieces);
  return tool;
}

std::expected<Tool, ToolError> make(const BallShape& s) {
  if (auto c = check_length("diameter_mm", s.diameter_mm); !c) return std::unexpected(c.error());
  if (auto c = check_length("length_mm", s.length_mm); !c) return std::unexpected(c.error());
  const double r = s.diameter_mm / 2;
  if (s.length_mm < r) return std::unexpected(too_short("must be at least half the diameter"));
  std::vector<ToolPiece> pieces{BallPiece{r, r}};
  if (s.length_mm > r) pieces.emplace_back(FrustumPiece{r, r, s.length_mm, r});
  return assemble(std::move(pieces));
}

std::expected<Tool, ToolError> make(const FlatShape& s) {
  if (auto c = check_length("diameter_mm", s.diameter_mm); !c) return std::unexpected(c.error());
  if (auto c = check_length("length_mm", s.length_mm); !c) return std::unexpected(c.error());
  const double r = s.diameter_mm / 2;
  return assemble({FrustumPiece{0, r, s.length_mm, r}});
}

std::expected<Tool, ToolError> make(const TaperShape& s) {
  if (auto c = check_length("diameter_mm", s.diameter_mm); !c) return std::unexpected(c.error());
  if (auto c = check_length("length_mm", s.length_mm); !c) return std::unexpected(c.error());
  if (auto c = check_angle("half_angle_deg", s.half_angle_deg, 90); !c) {
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
  return assemble(std::move(pieces));
}

std::expected<Tool, ToolError> make(const ConeEndShape& s) {
  if (auto c = check_length("diameter_mm", s.diameter_mm); !c) return std::unexpected(c.error());
  if (auto c = check_length("length_mm", s.length_mm); !c) return std::unexpected(c.error());
  if (auto c = check_angle("tip_angle_deg", s.tip_angle_deg, 180); !c) {
    return std::unexpected(c.error());
  }
  const double r = s.diameter_mm / 2;
  const double half = radians(s.tip_angle_deg) / 2;
  const double cone = r * std::cos(half) / std::sin(half);
  if (s.length_mm < cone) return std::unexpected(too_short("is shorter than the cone at the tip"));
  std::vector<ToolPiece> pieces{FrustumPiece{0, 0, cone, r}};
  if (s.length_mm > cone) pieces.emplace_back(FrustumPiece{cone, r, s.length_mm, r});
  return assemble(std::move(pieces));
}

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
  return {};
}

}  // namespace

std::expected<Tool, ToolError> make_tool(const ToolShape& shape) {
  return std::visit([](const auto& s) { return make(s); }, shape);
}

std::expected<Tool, ToolError> make_tool(std::vector<ToolPiece> pieces) {
  if (pieces.empty() || pieces.size() > kPiecesMax) {
    return std::unexpected(
        ToolError{ToolErrorCode::kTooManyPieces, "pieces", "must be between 1 and 64"});
  }
  for (const ToolPiece& piece : pieces) {
    std::string wrong = std::visit([](const auto& p) { return check_piece(p); }, piece);
    if (!wrong.empty()) {
      return std::unexpected(ToolError{ToolErrorCode::kOutOfRange, "pieces", std::move(wrong)});
    }
  }
  return assemble(std::move(pieces));
}

}  // namespace kerf
