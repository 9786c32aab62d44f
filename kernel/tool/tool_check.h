#pragma once

#include <expected>
#include <string>

#include "kernel/tool/tool.h"

namespace kerf {

/// What the definitions of shapes share: checks that name the field.
using ToolCheck = std::expected<void, ToolError>;

/// A length between kToolLengthMinMm and kToolLengthMaxMm.
ToolCheck check_length(const std::string& field, double value_mm);
/// A coordinate or a length that may be zero: finite, at least `least_mm`, at most
/// kToolLengthMaxMm.
ToolCheck check_coordinate(const std::string& field, double value_mm, double least_mm);
/// An angle strictly between two others.
ToolCheck check_angle(const std::string& field, double value_deg, double above_deg,
                      double below_deg);

double radians(double degrees);

/// The union of pieces that have been checked, with its lengths and radii.
Tool assemble(std::vector<ToolPiece> cutting, std::vector<ToolPiece> non_cutting = {});

/// Each shape's convex pieces, from the tip up.
std::expected<std::vector<ToolPiece>, ToolError> resolve(const AptShape& shape);

}  // namespace kerf
