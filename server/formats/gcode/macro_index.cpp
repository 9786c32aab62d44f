// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/macro_index.h"

#include <algorithm>
#include <charconv>

#include "server/formats/gcode/block.h"
#include "server/formats/letter_case.h"

namespace kerf {
namespace {

// The number after the last `word` of a code that is followed by digits only.
std::optional<int> number_after(std::string_view code, std::string_view word) {
  const std::size_t at = code.rfind(word);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view digits = code.substr(at + word.size());
  int number = 0;
  const char* end = digits.data() + digits.size();
  const auto read = std::from_chars(digits.data(), end, number);
  if (read.ec != std::errc{} || read.ptr != end) return std::nullopt;
  return number;
}

}  // namespace

std::optional<int> leading_number(std::string_view code, std::string_view letters,
                                  std::string_view& rest) {
  if (code.size() < 2 || letters.find(code[0]) == std::string_view::npos || !is_digit(code[1]))
    return std::nullopt;
  int number = 0;
  const auto read = std::from_chars(code.data() + 1, code.data() + code.size(), number);
  if (read.ec != std::errc{}) return std::nullopt;
  rest = code.substr(static_cast<std::size_t>(read.ptr - code.data()));
  return number;
}

MacroIndex::MacroIndex(const LineIndex& lines) {
  const DialectRules& rules = rules_of(Dialect::kFanuc);
  for (std::uint32_t i = 0; i < lines.size(); ++i) {
    const GcodeLine line = split_gcode_line(lines[i], rules);
    std::string_view code = line.code;
    if (const auto number = leading_number(code, "o:", code)) {
      marks_.push_back({0, Kind::kProgram, *number, i});
      programs_.push_back(i);
    }
    const auto program = static_cast<std::uint32_t>(programs_.size());
    if (const auto number = leading_number(code, "n", code))
      marks_.push_back({program, Kind::kSequence, *number, i});
    if (code.starts_with("while") || code.starts_with("wh[") || code.starts_with("do")) {
      if (const auto number = number_after(code, "do"))
        marks_.push_back({program, Kind::kDo, *number, i});
    } else if (code.starts_with("end")) {
      if (const auto number = number_after(code, "end"))
        marks_.push_back({program, Kind::kEnd, *number, i});
    }
  }
  std::ranges::sort(marks_);
}

std::uint32_t MacroIndex::program_around(std::size_t line) const {
  const auto after = std::ranges::upper_bound(programs_, line, [this](auto a, auto b) {
    ++comparisons_;
    return a < b;
  });
  return static_cast<std::uint32_t>(after - programs_.begin());
}

std::vector<MacroIndex::Mark>::const_iterator MacroIndex::first_from(const Mark& least) const {
  return std::ranges::lower_bound(marks_, least, [this](const Mark& a, const Mark& b) {
    ++comparisons_;
    return a < b;
  });
}

std::optional<std::size_t> MacroIndex::line_of(std::vector<Mark>::const_iterator mark,
                                               const Mark& wanted) const {
  if (mark == marks_.end() || mark->program != wanted.program || mark->kind != wanted.kind ||
      mark->number != wanted.number)
    return std::nullopt;
  return mark->line;
}

std::optional<std::size_t> MacroIndex::program(int number) const {
  const Mark wanted{0, Kind::kProgram, number, 0};
  return line_of(first_from(wanted), wanted);
}

std::optional<std::size_t> MacroIndex::sequence(int number, std::size_t line) const {
  Mark wanted{program_around(line), Kind::kSequence, number, static_cast<std::uint32_t>(line + 1)};
  if (const auto next = line_of(first_from(wanted), wanted)) return next;
  wanted.line = 0;
  return line_of(first_from(wanted), wanted);
}

std::optional<std::size_t> MacroIndex::end_of(int number, std::size_t line) const {
  const Mark wanted{program_around(line), Kind::kEnd, number, static_cast<std::uint32_t>(line + 1)};
  return line_of(first_from(wanted), wanted);
}

std::optional<std::size_t> MacroIndex::start_of(int number, std::size_t line) const {
  const Mark wanted{program_around(line), Kind::kDo, number, static_cast<std::uint32_t>(line)};
  const auto after = first_from(wanted);
  return after == marks_.begin() ? std::nullopt : line_of(after - 1, wanted);
}

}  // namespace kerf
