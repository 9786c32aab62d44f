// SPDX-License-Identifier: Apache-2.0
#include "kernel/tool/tool.h"

#include <algorithm>
#include <cmath>

#include "kernel/tool/outline.h"
#include "kernel/tool/tool_check.h"

namespace kerf {
namespace {

std::string check_piece(const BallPiece& p) {
  if (!std::isfinite(p.center_mm) || !std::isfinite(p.radius_mm)) return "is not finite";
  if (p.radius_mm <= 0 || p.radius_mm > kToolLengthMaxMm) return "has a radius out of range";
  if (p.center_mm < 0 || p.center_mm > kToolLengthMaxMm) return "has a center out of range";
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
  // The radius is a concave function of the height, so its minimum is at an end.
  const double least = p.center_r_mm + std::sqrt(r2 - std::max(below * below, above * above));
  if (least < -kOutlineEpsilonMm) return "has a negative radius";
  return {};
}

}  // namespace

ToolCheck check_pieces(const std::string& field, const std::vector<ToolPiece>& pieces) {
  if (pieces.size() > kToolPiecesMax) {
    return std::unexpected(
        ToolError{ToolErrorCode::kTooManyPieces, field, "resolves to more than 1024 pieces"});
  }
  for (const ToolPiece& piece : pieces) {
    std::string wrong = std::visit([](const auto& p) { return check_piece(p); }, piece);
    if (!wrong.empty()) {
      return std::unexpected(ToolError{ToolErrorCode::kOutOfRange, field, std::move(wrong)});
    }
  }
  return {};
}

std::expected<Tool, ToolError> make_tool(const ToolShape& shape, const ToolBody& body) {
  auto cutting = std::visit([](const auto& s) { return resolve(s); }, shape);
  if (!cutting) return std::unexpected(cutting.error());
  auto non_cutting = resolve(body, cutting_length_mm(shape));
  if (!non_cutting) return std::unexpected(non_cutting.error());
  return make_tool(*std::move(cutting), *std::move(non_cutting));
}

std::expected<Tool, ToolError> make_tool(std::vector<ToolPiece> cutting,
                                         std::vector<ToolPiece> non_cutting) {
  if (cutting.empty()) {
    return std::unexpected(
        ToolError{ToolErrorCode::kTooShort, "pieces", "must have at least one cutting piece"});
  }
  if (auto c = check_pieces("pieces", cutting); !c) return std::unexpected(c.error());
  if (auto c = check_pieces("non_cutting", non_cutting); !c) return std::unexpected(c.error());
  Tool tool;
  for (const ToolPiece& piece : cutting) {
    const Extent e = extent(piece);
    tool.length_mm = std::max(tool.length_mm, e.z1_mm);
    tool.radius_mm = std::max(tool.radius_mm, e.radius_mm);
  }
  tool.whole_length_mm = tool.length_mm;
  tool.whole_radius_mm = tool.radius_mm;
  for (const ToolPiece& piece : non_cutting) {
    const Extent e = extent(piece);
    tool.whole_length_mm = std::max(tool.whole_length_mm, e.z1_mm);
    tool.whole_radius_mm = std::max(tool.whole_radius_mm, e.radius_mm);
  }
  std::vector<ToolPiece> all = cutting;
  all.insert(all.end(), non_cutting.begin(), non_cutting.end());
  tool.whole_parts = convex_parts(all);
  tool.non_cutting_parts = convex_parts(non_cutting);
  tool.pieces = std::move(cutting);
  tool.non_cutting = std::move(non_cutting);
  return tool;
}

}  // namespace kerf
