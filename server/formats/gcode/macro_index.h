// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "server/formats/gcode/line_index.h"

namespace kerf {

/// Positions of the programs, sequence numbers and loops of a file with Macro B. Searches are
/// logarithmic.
class MacroIndex {
 public:
  explicit MacroIndex(const LineIndex& lines);

  /// The line (from 0) of the header O`number`.
  std::optional<std::size_t> program(int number) const;
  /// The line of sequence number N`number` in the program around `line`: the next one, else the
  /// first one.
  std::optional<std::size_t> sequence(int number, std::size_t line) const;
  /// The line of END`number` after `line`, and of DO`number` before it, in the same program.
  std::optional<std::size_t> end_of(int number, std::size_t line) const;
  std::optional<std::size_t> start_of(int number, std::size_t line) const;
  /// Comparisons that all searches have made.
  std::size_t comparisons() const { return comparisons_; }

 private:
  enum class Kind : std::uint8_t { kProgram, kSequence, kDo, kEnd };
  struct Mark {
    std::uint32_t program;  ///< number of headers before it; 0 for a header
    Kind kind;
    int number;
    std::uint32_t line;
    auto operator<=>(const Mark&) const = default;
  };
  /// Number of headers before or in a line.
  std::uint32_t program_around(std::size_t line) const;
  /// The first mark that is not less than another one.
  std::vector<Mark>::const_iterator first_from(const Mark& least) const;
  /// The line of a mark if it has the program, kind and number of `wanted`.
  std::optional<std::size_t> line_of(std::vector<Mark>::const_iterator mark,
                                     const Mark& wanted) const;

  std::vector<Mark> marks_;              ///< ascending
  std::vector<std::uint32_t> programs_;  ///< lines of all headers, ascending
  mutable std::size_t comparisons_ = 0;
};

/// The number of a sequence or program at the beginning of a code, after its letter: "n10g0" gives
/// 10 and, in `rest`, "g0", or nullopt if there is none.
std::optional<int> leading_number(std::string_view code, std::string_view letters,
                                  std::string_view& rest);

}  // namespace kerf
