// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <vector>

#include "kernel/math/tolerance.h"
#include "kernel/tool/tool.h"

namespace kerf {

// What the definitions of shapes share.

using ToolCheck = std::expected<void, ToolError>;
/// The convex pieces of a shape, from the tip up.
using Pieces = std::expected<std::vector<ToolPiece>, ToolError>;

/// A length between kToolLengthMinMm and kToolLengthMaxMm.
ToolCheck check_length(const std::string& field, double value_mm);
/// A coordinate or a length that may be zero: finite, at least `least_mm`, at most
/// kToolLengthMaxMm.
ToolCheck check_coordinate(const std::string& field, double value_mm, double least_mm);
/// An angle strictly between two others; not denormal, for nobody means one.
ToolCheck check_angle(const std::string& field, double value_deg, double above_deg,
                      double below_deg);
/// Pieces of a definition or a journal: their number, and each finite, ordered and within the
/// limits.
ToolCheck check_pieces(const std::string& field, const std::vector<ToolPiece>& pieces);

double radians(double degrees);

Pieces resolve(const BallShape& shape);
Pieces resolve(const FlatShape& shape);
Pieces resolve(const BullNoseShape& shape);
Pieces resolve(const TaperShape& shape);
Pieces resolve(const ConeEndShape& shape);
Pieces resolve(const AptShape& shape);
/// Errors name fields with the prefix before them.
Pieces resolve(const ProfileShape& shape, const std::string& prefix = "");
/// Shank and holder on a tool whose cutting part is so long.
Pieces resolve(const ToolBody& body, double cutting_length_mm);

}  // namespace kerf
