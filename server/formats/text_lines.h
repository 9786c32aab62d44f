// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace kerf {

/// Returns the character that ends the lines of a text: LF, or CR if it has no LF.
inline char line_end(std::string_view text) {
  return text.find('\n') == std::string_view::npos ? '\r' : '\n';
}

/// Iterates over the lines of a text. Lines end with LF, CR LF or, in a text without LF, CR; the CR
/// of CR LF is kept in the line.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : rest_(text), end_(line_end(text)) {}

  /// Moves to the next line. Returns false at the end of the text.
  bool next() {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find(end_);
    line_ = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
    ++number_;
    return true;
  }
  std::string_view line() const { return line_; }
  std::size_t number() const { return number_; }  ///< from 1

 private:
  std::string_view rest_, line_;
  char end_;
  std::size_t number_ = 0;
};

}  // namespace kerf
