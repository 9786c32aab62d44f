// SPDX-License-Identifier: Apache-2.0
#include "kernel/tool/tool_check.h"

#include <cmath>
#include <numbers>

namespace kerf {

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
  if (std::fpclassify(value_deg) == FP_SUBNORMAL) {
    return std::unexpected(
        ToolError{ToolErrorCode::kOutOfRange, field, "must not be a denormal number"});
  }
  if (value_deg <= above_deg || value_deg >= below_deg) {
    return std::unexpected(ToolError{ToolErrorCode::kOutOfRange, field,
                                     "must lie strictly between " + std::to_string(int(above_deg)) +
                                         " and " + std::to_string(int(below_deg)) + " degrees"});
  }
  return {};
}

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace kerf
