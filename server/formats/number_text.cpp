// SPDX-License-Identifier: Apache-2.0
#include "server/formats/number_text.h"

#include <array>
#include <cmath>
#include <cstdlib>

namespace kerf {
namespace {

// A double without exponent has at most 309 digits before its point or 1074 after it.
using Buffer = std::array<char, 1100>;

}  // namespace

std::string exact_text(double value) {
  Buffer buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value + 0.0,
                                 std::chars_format::fixed);
  return {buffer.data(), end.ptr};
}

std::from_chars_result number_of_chars(const char* first, const char* last, double& value,
                                       std::chars_format format) {
  auto result = std::from_chars(first, last, value, format);
  if (result.ec != std::errc::result_out_of_range) return result;
  const double nearest = std::strtod(std::string(first, result.ptr).c_str(), nullptr);
  if (std::abs(nearest) > 1) return result;
  value = nearest;
  result.ec = {};
  return result;
}

std::string decimal_text(double value, int decimals) {
  Buffer buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::fixed, decimals);
  std::string text(buffer.data(), end.ptr);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string significant_text(double value, int digits) {
  Buffer buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::scientific, digits - 1);
  double rounded = 0;
  std::from_chars(buffer.data(), end.ptr, rounded);
  return exact_text(rounded);
}

}  // namespace kerf
