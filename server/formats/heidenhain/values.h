// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace kerf {

/// The Q parameters of a program and the values of words and formulas. Angles are in degrees.
class KlartextValues {
 public:
  /// Returns the value of a number or of a parameter: "+5.5", "-Q3", "Q12". Throws ProgramFault.
  double of(const std::string& word) const;
  /// Computes a formula of "Q1 = …" or of FN 0 to FN 8: + - * / ^ DIV, parentheses, SIN COS TAN
  /// ASIN ACOS ATAN SQRT ABS INT FRAC NEG LN LOG EXP SGN LEN PI. Throws ProgramFault.
  double formula(std::string_view text) const;
  /// Assigns "Q1 = …". Returns false for any other text.
  bool assign(std::string_view text);
  void set(const std::string& name, double value) { values_[name] = value; }

 private:
  std::map<std::string, double> values_;  ///< "Q1", "QL5"
};

}  // namespace kerf
