// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "kernel/tool/tool_check.h"

namespace kerf {
namespace {

struct CuttingLength {
  double operator()(const ProfileShape& shape) const {
    return std::visit([](const auto& step) { return height(step); }, shape.steps.back());
  }
  double operator()(const AptShape& shape) const { return shape.h_mm; }
  double operator()(const auto& shape) const { return shape.length_mm; }

 private:
  static double height(const ProfilePoint& point) { return point.h_mm; }
  static double height(const auto& arc) { return arc.to.h_mm; }
};

ToolCheck check_top(const std::string& field, double top_mm) {
  if (top_mm <= kToolLengthMaxMm) return {};
  return std::unexpected(
      ToolError{ToolErrorCode::kOutOfRange, field, "makes the whole tool longer than 5000 mm"});
}

/// Appends a holder section above the height `top`, and raises `top` by its length.
ToolCheck stack(const std::string& field, const HolderSection& section, double& top,
                std::vector<ToolPiece>& pieces) {
  if (auto c = check_length(field + ".diameter_mm", section.diameter_mm); !c) return c;
  if (auto c = check_length(field + ".top_diameter_mm", section.top_diameter_mm); !c) return c;
  if (auto c = check_length(field + ".length_mm", section.length_mm); !c) return c;
  const double base = top;
  top += section.length_mm;
  pieces.emplace_back(
      FrustumPiece{base, section.diameter_mm / 2, top, section.top_diameter_mm / 2});
  return check_top(field + ".length_mm", top);
}

ToolPiece raised(BallPiece piece, double by_mm) {
  piece.center_mm += by_mm;
  return piece;
}
ToolPiece raised(FrustumPiece piece, double by_mm) {
  piece.z0_mm += by_mm;
  piece.z1_mm += by_mm;
  return piece;
}
ToolPiece raised(ArcPiece piece, double by_mm) {
  piece.center_z_mm += by_mm;
  piece.z0_mm += by_mm;
  piece.z1_mm += by_mm;
  // Each sum is rounded on its own, so the radius is enlarged to keep the ends within the arc.
  piece.radius_mm =
      std::max({piece.radius_mm, piece.center_z_mm - piece.z0_mm, piece.z1_mm - piece.center_z_mm});
  return piece;
}

}  // namespace

double cutting_length_mm(const ToolShape& shape) { return std::visit(CuttingLength{}, shape); }

Pieces resolve(const ToolBody& body, double cutting_length_mm) {
  std::vector<ToolPiece> pieces;
  double top = cutting_length_mm;
  if (body.shank) {
    const HolderSection cylinder{body.shank->diameter_mm, body.shank->diameter_mm,
                                 body.shank->length_mm};
    if (auto c = stack("shank", cylinder, top, pieces); !c) return std::unexpected(c.error());
  }
  if (!body.holder) return pieces;
  if (const auto* sections = std::get_if<std::vector<HolderSection>>(&*body.holder)) {
    if (sections->size() > kToolPiecesMax) {
      return std::unexpected(
          ToolError{ToolErrorCode::kTooManyPieces, "holder", "has more than 1024 sections"});
    }
    for (std::size_t i = 0; i < sections->size(); ++i) {
      const std::string field = "holder[" + std::to_string(i) + "]";
      if (auto c = stack(field, (*sections)[i], top, pieces); !c) {
        return std::unexpected(c.error());
      }
    }
    return pieces;
  }
  auto profile = resolve(std::get<ProfileShape>(*body.holder), "holder.");
  if (!profile) return profile;
  for (const ToolPiece& piece : *profile) {
    pieces.push_back(std::visit([&](const auto& p) { return raised(p, top); }, piece));
  }
  top += kerf::cutting_length_mm(std::get<ProfileShape>(*body.holder));
  if (auto c = check_top("holder.profile_mm", top); !c) return std::unexpected(c.error());
  return pieces;
}

}  // namespace kerf
