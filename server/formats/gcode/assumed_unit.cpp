// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/assumed_unit.h"

#include <string>

#include "server/formats/letter_case.h"
#include "server/formats/text_lines.h"

namespace kerf {
namespace {

bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }

struct Units {
  bool code = false, inches = false, mm = false;
};

// Whether a number precedes `at`, perhaps with blanks between.
bool behind_number(const std::string& text, std::size_t at) {
  while (at > 0 && text[at - 1] == ' ') --at;
  return at > 0 && (is_digit(text[at - 1]) || text[at - 1] == '.');
}

bool is_unit(const std::string& text, std::size_t at, std::string_view unit) {
  if (text.compare(at, unit.size(), unit) != 0 || !behind_number(text, at)) return false;
  return at + unit.size() >= text.size() || !is_capital(text[at + unit.size()]);
}

// Finds units in a line: G20, G21, G70 and G71 in the code, units after numbers in comments.
void look(const std::string& line, Units& units) {
  int depth = 0;
  for (std::size_t at = 0; at < line.size(); ++at) {
    const char c = line[at];
    if (c == '(') ++depth;
    if (c == ')' && depth > 0) --depth;
    if (c == ';') depth = 1;
    if (depth == 0) {
      if (c != 'G' || at + 2 >= line.size()) continue;
      const std::string code = line.substr(at + 1, 2);
      const bool longer = at + 3 < line.size() && (is_digit(line[at + 3]) || line[at + 3] == '.');
      if (!longer && (code == "20" || code == "21" || code == "70" || code == "71"))
        units.code = true;
    } else {
      units.inches = units.inches || is_unit(line, at, "IN") || is_unit(line, at, "INCH") ||
                     (c == '"' && behind_number(line, at));
      units.mm = units.mm || is_unit(line, at, "MM");
    }
  }
}

}  // namespace

std::size_t line_of_inches(std::string_view program) {
  std::size_t found = 0;
  TextLines walk(program);
  while (walk.next()) {
    Units units;
    look(to_upper(std::string(walk.line())), units);
    if (units.code || units.mm) return 0;
    if (units.inches && found == 0) found = walk.number();
  }
  return found;
}

}  // namespace kerf
