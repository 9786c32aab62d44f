// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "server/formats/gcode/source.h"

namespace kerf {

/// Where the programs, sequence numbers and loops of a file with Macro B begin and end.
class MacroIndex {
 public:
  explicit MacroIndex(const GcodeFile& file);

  /// The line (from 0) of the header O`number`.
  std::optional<std::size_t> program(int number) const;
  /// The line of sequence number N`number` in the program around `line`: the next one, else the
  /// first one.
  std::optional<std::size_t> sequence(int number, std::size_t line) const;
  /// The line of END`number` after `line`, and of DO`number` before it, in the same program.
  std::optional<std::size_t> end_of(int number, std::size_t line) const;
  std::optional<std::size_t> start_of(int number, std::size_t line) const;

 private:
  enum class Kind { kProgram, kSequence, kDo, kEnd };
  struct Mark {
    std::size_t line;
    Kind kind;
    int number;
  };
  /// The marks of the program around a line.
  std::pair<std::size_t, std::size_t> program_around(std::size_t line) const;

  std::vector<Mark> marks_;  ///< ascending lines
};

/// The number of a sequence or program at the beginning of a code, after its letter: "n10g0" gives
/// 10 and, in `rest`, "g0"; nullopt if there is none.
std::optional<int> leading_number(std::string_view code, std::string_view letters,
                                  std::string_view& rest);

}  // namespace kerf
