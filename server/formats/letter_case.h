// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf {

// ASCII only, independent of the locale: codes, words and file extensions.

constexpr char to_lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }
constexpr char to_upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

inline std::string to_lower(std::string text) {
  for (char& c : text) c = to_lower(c);
  return text;
}
inline std::string to_upper(std::string text) {
  for (char& c : text) c = to_upper(c);
  return text;
}

}  // namespace kerf
