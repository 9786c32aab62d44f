// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace kerf {

/// The R parameters and the variables (DEF) of a SINUMERIK program, and its expressions. Text is in
/// capital letters. Angles are in degrees. Throws ProgramFault.
class SinumerikValues {
 public:
  /// Computes the expression at `at` and moves `at` after it: numbers, R1, R[…], variables, + - * /
  /// DIV MOD, == <> < > <= >=, AND OR XOR NOT, SIN COS TAN ASIN ACOS ATAN2 SQRT POT ABS TRUNC ROUND
  /// LN EXP MINVAL MAXVAL, TRUE, FALSE, $PI. Comparisons bind weakest.
  double expression(std::string_view text, std::size_t& at) const;
  /// Computes a text that is one expression.
  double of(std::string_view text) const;
  /// Returns the value of a variable, 0 for an R parameter that is not assigned.
  double value_of(const std::string& name) const;
  /// Defines a variable. An existing value is kept.
  void define(const std::string& name) { values_.try_emplace(name, 0.0); }
  /// Whether the name is an R parameter or a variable.
  bool has(const std::string& name) const;
  void set(const std::string& name, double value) { values_[name] = value; }

 private:
  std::map<std::string, double> values_;  ///< "R5", names of DEF
};

/// Whether a character may occur in a name.
bool is_sinumerik_name(char c);
/// Whether a text begins with a complete word.
bool begins_word(std::string_view text, std::string_view word);
/// Returns the first position from `at` on without a blank.
std::size_t skip_blanks(std::string_view text, std::size_t at);

}  // namespace kerf
