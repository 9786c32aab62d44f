// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/tool_lexicon.h"

namespace kerf {

/// The statements of a comment about a tool, before they are combined into a shape. Lengths in mm.
struct ToolFacts {
  /// A number that may be the diameter.
  struct Size {
    double mm = 0;
    bool with_unit = false;    ///< a unit or a fraction is written
    bool named = false;        ///< by a word or sign for a diameter, a gauge or a thread
    bool before_kind = false;  ///< a kind of tool follows it: "6 BALL"
  };
  std::bitset<64> words;  ///< the meanings that occur, by ToolWord
  std::vector<Size> sizes;
  std::optional<double> corner_mm, radius_mm;  ///< radius: only one named R
  std::optional<double> angle_deg;
  bool angle_of_side = false;       ///< stated as that of a taper
  bool angle_of_point = false;      ///< stated as that of the tip
  bool has_length = false;          ///< a length is stated, which no shape uses
  std::vector<std::string> unread;  ///< words, numbers and signs that no rule explains

  bool has(ToolWord word) const { return words.test(static_cast<std::size_t>(word)); }
};

/// Reads the words of a comment, each by one rule of a grammar. A number with its unit belongs to
/// the word before or after it that names it (D, DIA, R, CR, DEG, LENGTH, FLUTES, SHANK, H …).
/// Numbers without a unit are in units of `unit_mm`. A word without a rule is unread.
ToolFacts read_tool_facts(std::string_view words, double unit_mm);

}  // namespace kerf
