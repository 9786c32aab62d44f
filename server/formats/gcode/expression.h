// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>

#include "server/formats/gcode/parameters.h"

namespace kerf {

/// Greatest distance from an integer for a value that must be one (LinuxCNC's value).
inline constexpr double kGcodeIntegerTolerance = 1e-4;
/// Values nearer than this are equal for eq and ne (LinuxCNC's value).
inline constexpr double kGcodeEqualTolerance = 1e-4;
/// Values nearer than this are equal in the comparisons of Macro B, whose controls count decimally.
inline constexpr double kMacroEqualTolerance = 1e-8;
/// Deepest nesting of brackets, signs and # in one value. Bounds the recursion on hostile lines.
inline constexpr int kGcodeNestingMax = 100;

/// A parser for the values on one line of G-code in lower case without blanks: numbers,
/// [expressions], #parameters and functions. Angles are in degrees. Throws ProgramFault.
class GcodeValueReader {
 public:
  /// `position_readable`: whether #5420 to #5428 may be read. They may not during cutter
  /// compensation, because the tool is offset from the programmed position.
  GcodeValueReader(std::string_view line, const GcodeParameters& parameters,
                   bool position_readable = true)
      : line_(line), parameters_(parameters), position_readable_(position_readable) {}

  bool done() const { return at_ >= line_.size(); }
  /// The next character, '\0' at the end.
  char peek() const { return done() ? '\0' : line_[at_]; }
  void skip() { ++at_; }
  std::size_t position() const { return at_; }
  /// Marks the start of a word, so that errors name the whole word with its letter.
  void begin_word() { word_ = at_; }
  std::string text_since(std::size_t start) const {
    return std::string(line_.substr(start, at_ - start));
  }

  /// Reads a value after a letter. Binary operators are allowed within brackets only.
  double value();
  /// Reads a value with binary operators, which Macro B allows to the right of '='.
  double expression();
  /// Reads the number or name of a parameter after its '#'.
  std::variant<int, std::string> parameter_key();
  /// Reads an integer value. `meaning` names it in the error.
  int integer(const char* meaning);
  /// Reads "[…]". The next character must be '['.
  double bracket();
  /// Reads the name after '<' and the closing '>'.
  std::string name();
  /// Whether a function of Macro B comes next.
  bool at_function() const;
  /// Skips `word` and returns true if it comes next.
  bool accept(std::string_view word);

 private:
  double finite(double result, std::size_t start) const;
  double arc_tangent();
  double value_within();
  double number();
  double function();
  double parameter();
  double exists();
  double operation(double left, int precedence);
  void expect(char c);
  std::string word_since(std::size_t start) const;
  [[noreturn]] void reject(const std::string& reason) const;

  std::string_view line_;
  const GcodeParameters& parameters_;
  bool position_readable_;
  std::size_t at_ = 0;
  std::size_t word_ = std::string_view::npos;
  int depth_ = 0;
};

/// Returns whether `value` is within kGcodeIntegerTolerance of an integer and within ±1e9.
bool is_gcode_integer(double value);

}  // namespace kerf
