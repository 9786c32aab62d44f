// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/control/fault.h"
#include "server/formats/text_lines.h"

namespace kerf {

/// A statement of APT CL data: "GOTO / 1, 2, 3" is GOTO with three minor words.
struct AptStatement {
  std::string major;               ///< upper case, without blanks: "TOOLPATH"
  std::vector<std::string> minor;  ///< values after '/', upper case, without blanks
  std::string text = {};           ///< in a statement of free text: the text after the major word
  bool is_text = false;            ///< PARTNO, PPRINT, INSERT, … : `minor` is empty
  bool creo = false;               ///< a comment "$$->" of Creo stood before it
};

/// Divides APT CL data into statements. "$$" begins a comment. '$' at the end of a line continues
/// the statement on the next one, unless that begins another GOTO.
class AptStatements {
 public:
  explicit AptStatements(std::string_view text) : lines_(text) {}

  /// Returns the next statement, or nullopt at the end of the text. Throws ProgramFault.
  std::optional<AptStatement> next();
  /// Line on which the last statement began, from 1.
  std::size_t line() const { return line_; }

 private:
  bool next_line();

  TextLines lines_;
  std::optional<std::string> ahead_;  ///< a line read ahead that continues nothing
  std::size_t ahead_line_ = 0, line_ = 0;
  bool creo_ = false;
};

/// Returns a word as a finite number, or nullopt.
std::optional<double> apt_number(std::string_view word);
/// The same, but throws ProgramFault for a word that is not a number.
double apt_number_of(const std::string& word);

/// Whether a text is APT CL data: one of its first lines is a statement of APT such as "GOTO/", and
/// none is a block of G-code.
bool is_apt(std::string_view text);

}  // namespace kerf
