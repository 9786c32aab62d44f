// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/plain_number.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace kerf::agent {

std::string plain_number(double value, int digits) {
  assert(std::isfinite(value));
  if (value == 0) return "0";
  const double step = std::pow(10.0, std::floor(std::log10(std::abs(value))) + 1 - digits);
  const double rounded = std::round(value / step) * step;
  // Rounding may have added a digit before the point.
  const double size = std::floor(std::log10(std::abs(rounded)));
  const int decimals = std::max(0, digits - 1 - static_cast<int>(size));
  std::ostringstream out;
  out << std::fixed << std::setprecision(decimals) << rounded;
  std::string text = out.str();
  if (decimals == 0) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

}  // namespace kerf::agent
