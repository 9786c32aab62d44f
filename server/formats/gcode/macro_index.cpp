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
  const auto read = std::from_chars(digits.begin(), digits.end(), number);
  if (read.ec != std::errc{} || read.ptr != digits.end()) return std::nullopt;
  return number;
}

}  // namespace

std::optional<int> leading_number(std::string_view code, std::string_view letters,
                                  std::string_view& rest) {
  if (code.size() < 2 || letters.find(code[0]) == std::string_view::npos || !is_digit(code[1]))
    return std::nullopt;
  int number = 0;
  const auto read = std::from_chars(code.begin() + 1, code.end(), number);
  if (read.ec != std::errc{}) return std::nullopt;
  rest = code.substr(static_cast<std::size_t>(read.ptr - code.begin()));
  return number;
}

MacroIndex::MacroIndex(const GcodeFile& file) {
  const DialectRules& rules = rules_of(Dialect::kFanuc);
  for (std::size_t i = 0; i < file.lines.size(); ++i) {
    const GcodeLine line = split_gcode_line(file.lines[i], rules);
    std::string_view code = line.code;
    if (const auto number = leading_number(code, "o:", code))
      marks_.push_back({i, Kind::kProgram, *number});
    if (const auto number = leading_number(code, "n", code))
      marks_.push_back({i, Kind::kSequence, *number});
    if (code.starts_with("while") || code.starts_with("wh[") || code.starts_with("do")) {
      if (const auto number = number_after(code, "do")) marks_.push_back({i, Kind::kDo, *number});
    } else if (code.starts_with("end")) {
      if (const auto number = number_after(code, "end")) marks_.push_back({i, Kind::kEnd, *number});
    }
  }
}

std::pair<std::size_t, std::size_t> MacroIndex::program_around(std::size_t line) const {
  const auto after = std::ranges::upper_bound(marks_, line, {}, &Mark::line);
  auto first = after;
  while (first != marks_.begin() && (first - 1)->kind != Kind::kProgram) --first;
  const auto last = std::find_if(after, marks_.end(),
                                 [](const Mark& mark) { return mark.kind == Kind::kProgram; });
  return {static_cast<std::size_t>(first - marks_.begin()),
          static_cast<std::size_t>(last - marks_.begin())};
}

std::optional<std::size_t> MacroIndex::program(int number) const {
  for (const Mark& mark : marks_)
    if (mark.kind == Kind::kProgram && mark.number == number) return mark.line;
  return std::nullopt;
}

std::optional<std::size_t> MacroIndex::sequence(int number, std::size_t line) const {
  const auto [first, last] = program_around(line);
  std::optional<std::size_t> found;
  for (std::size_t i = first; i < last; ++i) {
    if (marks_[i].kind != Kind::kSequence || marks_[i].number != number) continue;
    if (marks_[i].line > line) return marks_[i].line;
    if (!found) found = marks_[i].line;
  }
  return found;
}

std::optional<std::size_t> MacroIndex::end_of(int number, std::size_t line) const {
  const auto [first, last] = program_around(line);
  for (std::size_t i = first; i < last; ++i)
    if (marks_[i].kind == Kind::kEnd && marks_[i].number == number && marks_[i].line > line)
      return marks_[i].line;
  return std::nullopt;
}

std::optional<std::size_t> MacroIndex::start_of(int number, std::size_t line) const {
  const auto [first, last] = program_around(line);
  std::optional<std::size_t> found;
  for (std::size_t i = first; i < last && marks_[i].line < line; ++i)
    if (marks_[i].kind == Kind::kDo && marks_[i].number == number) found = marks_[i].line;
  return found;
}

}  // namespace kerf
