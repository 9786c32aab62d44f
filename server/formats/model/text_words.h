// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <type_traits>

#include "server/formats/number_text.h"

namespace kerf {

/// Splits text into words and counts lines. A line ends with LF, CR LF or CR, independently for
/// each line, because editors and converters leave files with several kinds.
class TextWords {
 public:
  /// `backslash_joins`: a line whose last character is a backslash continues on the next one.
  explicit TextWords(std::string_view text, bool backslash_joins = false)
      : text_(text), backslash_joins_(backslash_joins) {}
  std::size_t line() const { return line_; }
  std::size_t position() const { return at_; }
  /// Returns the next word, or empty at the end.
  std::string_view next() {
    skip(true);
    return take();
  }
  /// Returns the next word of this line, or empty at its end.
  std::string_view next_in_line() {
    skip(false);
    return take();
  }
  void skip_line() {
    while (at_ < text_.size() && !ends_line()) {
      const std::size_t joint = joint_size();
      line_ += joint > 0 ? 1 : 0;
      at_ += std::max<std::size_t>(joint, 1);
    }
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  /// Whether a line ends with this character; CR LF ends with the second.
  bool ends_line() const {
    return text_[at_] == '\n' ||
           (text_[at_] == '\r' && (at_ + 1 == text_.size() || text_[at_ + 1] != '\n'));
  }
  /// The number of characters of a backslash and the line end after it, or 0 if there is none here.
  std::size_t joint_size() const {
    if (!backslash_joins_ || text_[at_] != '\\') return 0;
    const std::string_view rest = text_.substr(at_ + 1, 2);
    if (rest == "\r\n") return 3;
    return rest.starts_with('\n') || rest.starts_with('\r') ? 2 : 0;
  }
  void skip(bool lines) {
    while (at_ < text_.size()) {
      if (const std::size_t joint = joint_size(); joint > 0) {
        at_ += joint;
        ++line_;
      } else if (is_blank(text_[at_]) && (lines || !ends_line())) {
        line_ += ends_line() ? 1 : 0;
        ++at_;
      } else {
        return;
      }
    }
  }
  std::string_view take() {
    const std::size_t first = at_;
    while (at_ < text_.size() && !is_blank(text_[at_]) && joint_size() == 0) ++at_;
    return text_.substr(first, at_ - first);
  }
  std::string_view text_;
  bool backslash_joins_;
  std::size_t at_ = 0, line_ = 1;
};

/// Parses a word as a number with an optional leading +. Empty if any character remains.
template <class T>
std::optional<T> word_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  T value{};
  std::from_chars_result read{};
  if constexpr (std::is_same_v<T, double>) {
    read = number_of_chars(word.data(), word.data() + word.size(), value);
  } else {
    read = std::from_chars(word.data(), word.data() + word.size(), value);
  }
  const auto [end, code] = read;
  if (word.empty() || code != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

inline bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return (x | 0x20) == (y | 0x20); });
}

}  // namespace kerf
