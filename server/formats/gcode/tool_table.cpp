// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/tool_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/expression.h"
#include "server/formats/letter_case.h"
#include "server/formats/number_text.h"
#include "server/formats/scene.h"
#include "server/formats/text_lines.h"

namespace kerf {
namespace {

// Greatest magnitude of a number in a tool table, in any unit.
constexpr double kValueMax = 1e6;

double number(std::string_view word) {
  double value = 0;
  const char* first = word.data() + 1 + (word.size() > 1 && word[1] == '+' ? 1 : 0);
  const auto read = number_of_chars(first, word.data() + word.size(), value);
  if (read.ec != std::errc{} || read.ptr != word.data() + word.size() ||
      !(std::abs(value) <= kValueMax))
    throw ProgramFault{std::string(word), "must be a letter and a number of at most 1000000"};
  return value;
}

int integer(std::string_view word, double least, double most) {
  const double value = number(word);
  if (!is_gcode_integer(value) || value < least || value > most)
    throw ProgramFault{std::string(word), "must be an integer from " +
                                              std::to_string(static_cast<int>(least)) + " to " +
                                              std::to_string(static_cast<int>(most))};
  return static_cast<int>(std::lround(value));
}

void read_word(ToolTableEntry& tool, std::string_view word) {
  constexpr std::string_view kOffsetLetters = "XYZABC";
  const char letter = to_upper(word.front());
  if (const auto axis = kOffsetLetters.find(letter); axis != std::string_view::npos) {
    tool.offset[axis] = number(word);
    return;
  }
  switch (letter) {
    case 'T':
      tool.number = integer(word, 1, 999'999);
      return;
    case 'P':
      tool.pocket = integer(word, 0, 999'999);
      return;
    case 'D':
      tool.diameter_mm = number(word);
      return;
    case 'I':
      tool.front_angle_deg = number(word);
      return;
    case 'J':
      tool.back_angle_deg = number(word);
      return;
    case 'Q':
      tool.orientation = integer(word, 0, 9);
      return;
    case 'U':
    case 'V':
    case 'W':
      if (number(word) == 0) return;
      throw ProgramFault{std::string(word), "is an offset of U, V or W, which are not supported"};
    default:
      throw ProgramFault{std::string(word),
                         "is not a word of a tool table; use T P X Y Z A B C D I J Q"};
  }
}

void read_line(ToolTable& table, std::string_view line) {
  line = line.substr(0, line.find(';'));
  constexpr std::string_view kBlank = " \t\r";
  ToolTableEntry tool;
  bool any = false;
  for (auto at = line.find_first_not_of(kBlank); at != std::string_view::npos;
       at = line.find_first_not_of(kBlank, at)) {
    const auto end = std::min(line.find_first_of(kBlank, at), line.size());
    read_word(tool, line.substr(at, end - at));
    any = true;
    at = end;
  }
  if (!any) return;
  if (tool.number == 0)
    throw ProgramFault{std::string(line), "requires a T word, the number of the tool"};
  if (table.size() >= kToolTableMax)
    throw ProgramFault{
        "", "the table exceeds the limit of " + std::to_string(kToolTableMax) + " tools"};
  if (!table.emplace(tool.number, tool).second)
    throw ProgramFault{"T" + std::to_string(tool.number), "appears twice in the table"};
}

}  // namespace

std::expected<ToolTable, ProgramError> read_tool_table(const std::string& name,
                                                       std::string_view text,
                                                       double machine_unit_mm) {
  ToolTable table;
  TextLines lines(text);
  while (lines.next()) {
    try {
      read_line(table, lines.line());
    } catch (const ProgramFault& fault) {
      return std::unexpected(ProgramError{name, lines.number(), fault.word, fault.reason});
    }
  }
  for (auto& [number, tool] : table) {
    for (std::size_t i = 0; i < 3; ++i) tool.offset[i] *= machine_unit_mm;
    tool.diameter_mm *= machine_unit_mm;
  }
  return table;
}

ToolTable tool_table_of(const Scene& scene) {
  ToolTable table;
  for (const auto& [id, tool] : scene.tools) {
    const int number = static_cast<int>(id);
    table[number] = {
        .number = number, .pocket = number, .offset = {}, .diameter_mm = 2 * tool.tool.radius_mm};
  }
  return table;
}

}  // namespace kerf
