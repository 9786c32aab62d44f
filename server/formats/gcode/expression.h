// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>

#include "server/formats/control/formula.h"
#include "server/formats/gcode/parameters.h"

namespace kerf {

/// Greatest distance from an integer for a value that must be one (LinuxCNC's value).
inline constexpr double kGcodeIntegerTolerance = 1e-4;
/// Values nearer than this are equal for eq and ne (LinuxCNC's value).
inline constexpr double kGcodeEqualTolerance = 1e-4;
/// Values nearer than this are equal in the comparisons of Macro B, whose controls count decimally.
inline constexpr double kMacroEqualTolerance = 1e-8;

/// A parser for the values on one line of G-code in lower case without blanks: numbers,
/// [expressions], #parameters and functions. Macro B allows binary operators without brackets to
/// the right of '='. Throws ProgramFault.
class GcodeValueReader final : public FormulaReader {
 public:
  /// `position_readable`: whether #5420 to #5428 may be read. They may not during cutter
  /// compensation, because the tool is offset from the programmed position.
  GcodeValueReader(std::string_view line, const GcodeParameters& parameters,
                   bool position_readable = true);

  /// Marks the start of a word, so that errors name the whole word with its letter.
  void begin_word() { word_ = position(); }
  std::string text_since(std::size_t start) const {
    return std::string(text().substr(start, position() - start));
  }
  /// Reads the number or name of a parameter after its '#'.
  std::variant<int, std::string> parameter_key();
  /// Reads an integer value. `meaning` names it in the error.
  int integer(const char* meaning);
  /// Reads the name after '<' and the closing '>'.
  std::string name();
  /// Whether a function of Macro B comes next.
  bool at_function() const;

 private:
  double operand() override;
  double checked(double value, std::size_t start) const override;
  double apply(const FormulaOperator& op, double left, double right,
               std::size_t start) const override;
  std::string word_here() const override;
  std::string word_since(std::size_t start) const override;
  double arc_tangent();
  double function();
  double parameter();
  double exists();

  const GcodeParameters& parameters_;
  bool position_readable_;
  std::size_t word_ = std::string_view::npos;
};

/// Returns whether `value` is within kGcodeIntegerTolerance of an integer and within ±1e9.
bool is_gcode_integer(double value);

}  // namespace kerf
