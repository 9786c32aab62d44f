// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>

#include "server/formats/gcode/parameters.h"

namespace kerf {

/// A number differs from a whole one by at most this where a whole one is asked for (LinuxCNC's
/// figure).
inline constexpr double kGcodeIntegerTolerance = 1e-4;
/// eq and ne treat numbers nearer than this as equal (LinuxCNC's figure).
inline constexpr double kGcodeEqualTolerance = 1e-4;
/// Deepest nesting of brackets, signs and # in one value: keeps hostile lines off the stack.
inline constexpr int kGcodeNestingMax = 100;

/// Reads values from one line of G-code that is in lower case and without blanks: numbers,
/// [expressions], #parameters, functions. Angles are degrees. Throws GcodeFault.
class GcodeValueReader {
 public:
  /// `position_readable`: #5420 to #5428 may be asked for (not while the cutter's radius is
  /// compensated, since the tool is elsewhere).
  GcodeValueReader(std::string_view line, const GcodeParameters& parameters,
                   bool position_readable = true)
      : line_(line), parameters_(parameters), position_readable_(position_readable) {}

  bool done() const { return at_ >= line_.size(); }
  /// The next character, '\0' at the end.
  char peek() const { return done() ? '\0' : line_[at_]; }
  void skip() { ++at_; }
  std::size_t position() const { return at_; }
  std::string text_since(std::size_t start) const {
    return std::string(line_.substr(start, at_ - start));
  }

  /// A value as it may stand after a letter. Operators are understood only within brackets.
  double value();
  /// The number or name of a parameter; the '#' has been read.
  std::variant<int, std::string> parameter_key();
  /// A value that must be whole.
  int integer(const char* what);
  /// "[…]"; the next character must be '['.
  double bracket();
  /// The name within "<…>"; the '<' has been read.
  std::string name();
  /// Reads over `word` if it comes next.
  bool accept(std::string_view word);

 private:
  double value_within();
  double number();
  double function();
  double parameter();
  double exists();
  double operation(double left, int precedence);
  void expect(char c);
  [[noreturn]] void reject(const std::string& reason) const;

  std::string_view line_;
  const GcodeParameters& parameters_;
  bool position_readable_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

/// Whole number nearest to `value`, or none if it is farther than kGcodeIntegerTolerance or beyond
/// ±1e9.
bool is_gcode_integer(double value);

}  // namespace kerf
