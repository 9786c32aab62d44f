// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// A word of letters, a number with its unit, or a sign, of the words that describe a tool.
struct ToolToken {
  std::string word;  ///< upper case; empty for a number
  double value = 0;
  double unit_mm = 0;  ///< 0: not stated
  bool degrees = false;
  bool whole = false;   ///< a number of digits only, after a blank or at the beginning
  bool glued = false;   ///< no blank before it
  bool serial = false;  ///< a counter behind a name, as in "Endmill001"
  bool is_number() const { return word.empty(); }
};

/// Divides words into tokens. Numbers: 6, 6.35, 6,35, .25, 1/4, 1-1/4 and 1 1/4. A fraction is in
/// inches. Blanks belong to no token. Accented letters, in UTF-8 or Latin-1, become ASCII ("FRÄSER"
/// is FRAESER, "diamètre" is DIAMETRE), and the signs of a diameter become the word DIA.
std::vector<ToolToken> tool_tokens(std::string_view words);

}  // namespace kerf
