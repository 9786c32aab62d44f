// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/number_in.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {

CLI::Validator number_in(double least, double most, Numbers numbers) {
  const bool whole = numbers == Numbers::kWhole;
  const auto check = [least, most, whole](const std::string& text) -> std::string {
    const auto number = to_number(text);
    const bool good = number && *number >= least && *number <= most;
    if (good && !(whole && *number != std::floor(*number))) return "";
    constexpr int kDigits = 10;  // no power of ten
    std::ostringstream reason;
    reason << std::setprecision(kDigits) << "must be a " << (whole ? "whole number" : "number")
           << " from " << least << " to " << most;
    return reason.str();
  };
  // Larger bounds are sanity limits; --help omits them.
  constexpr double kShownMax = 1e5;
  std::ostringstream name;
  if (most < kShownMax) name << least << ".." << most;
  return {check, name.str()};
}

}  // namespace kerf::agent
