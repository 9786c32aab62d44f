// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <utility>
#include <vector>

#include "kernel/math/tolerance.h"
#include "kernel/tool/tool.h"

namespace kerf {

// Checks shared by the definitions of all shapes, and the resolution of each shape.

using ToolCheck = std::expected<void, ToolError>;
/// The convex pieces of a shape, from the tip up.
using Pieces = std::expected<std::vector<ToolPiece>, ToolError>;

inline std::unexpected<ToolError> reject(ToolErrorCode code, std::string field,
                                         std::string reason) {
  return std::unexpected(ToolError{code, std::move(field), std::move(reason)});
}

/// Checks for a length between kToolLengthMinMm and kToolLengthMaxMm.
ToolCheck check_length(const std::string& field, double value_mm);
/// Checks for a coordinate or a length that may be zero: finite, in [least_mm, kToolLengthMaxMm].
ToolCheck check_coordinate(const std::string& field, double value_mm, double least_mm);
/// Checks for an angle strictly between two limits. Denormal numbers are rejected, because they are
/// always a mistake.
ToolCheck check_angle(const std::string& field, double value_deg, double above_deg,
                      double below_deg);
/// Checks the number of pieces, and that each is finite, ordered and within the limits.
ToolCheck check_pieces(const std::string& field, const std::vector<ToolPiece>& pieces);

double radians(double degrees);

Pieces resolve(const BallShape& shape);
Pieces resolve(const FlatShape& shape);
Pieces resolve(const BullNoseShape& shape);
Pieces resolve(const TaperShape& shape);
Pieces resolve(const ConeEndShape& shape);
Pieces resolve(const AptShape& shape);
/// Field names in errors start with `prefix`.
Pieces resolve(const ProfileShape& shape, const std::string& prefix = "");
/// Resolves shank and holder above a cutting part of this length.
Pieces resolve(const ToolBody& body, double cutting_length_mm);

}  // namespace kerf
