// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/turning.h"

#include <algorithm>
#include <array>
#include <optional>

#include "server/formats/letter_case.h"
#include "server/formats/text_lines.h"

namespace kerf {
namespace {

constexpr std::size_t kTurningLinesMax = 5'000;

// The code of a line in upper case, without comments and blanks.
std::string code_of(std::string_view line) {
  std::string code;
  int depth = 0;
  for (const char c : line) {
    if (c == ';' && depth == 0) break;
    if (c == '(') ++depth;
    if (depth == 0 && c > ' ') code += to_upper(c);
    if (c == ')' && depth > 0) --depth;
  }
  return code;
}

// Whether a word with a value, "X-0.06", is in the code, not within a longer word.
bool has_word(const std::string& code, char letter) {
  for (std::size_t at = code.find(letter); at != std::string::npos;
       at = code.find(letter, at + 1)) {
    const char before = at > 0 ? code[at - 1] : '0';
    const char after = at + 1 < code.size() ? code[at + 1] : 'A';
    const bool starts = before < 'A' || before > 'Z';
    if (starts && (is_digit(after) || after == '-' || after == '.' || after == '+')) return true;
  }
  return false;
}

bool has_code(const std::string& code, std::string_view text) {
  for (std::size_t at = code.find(text); at != std::string::npos; at = code.find(text, at + 1)) {
    const char next = at + text.size() < code.size() ? code[at + text.size()] : ' ';
    if (!is_digit(next) && next != '.') return true;
  }
  return false;
}

// Returns a lathe code of a line, or nullptr.
const char* sign_in(const std::string& code) {
  if (has_code(code, "G50") && has_word(code, 'S')) return "G50 S";
  if (has_code(code, "G96")) return "G96";
  for (const char* cycle : {"G70", "G71", "G72", "G73", "G74", "G75", "G76"})
    if (has_code(code, cycle) && has_word(code, 'P') && has_word(code, 'Q')) return cycle;
  const bool u = has_word(code, 'U'), w = has_word(code, 'W');
  if ((u && w) || ((u || w) && (has_word(code, 'X') || has_word(code, 'Z')))) return "U or W";
  return nullptr;
}

}  // namespace

std::string sign_of_turning(std::string_view text) {
  std::string sign;
  bool x = false, z = false;
  TextLines lines(text);
  while (lines.next() && lines.number() <= kTurningLinesMax) {
    const std::string code = code_of(lines.line());
    // The number of a program may be followed by its name.
    if (code.starts_with('O') || code.starts_with(':')) continue;
    if (has_word(code, 'Y')) return {};
    x = x || has_word(code, 'X');
    z = z || has_word(code, 'Z');
    if (const char* found = sign_in(code); found != nullptr && sign.empty())
      sign = "line " + std::to_string(lines.number()) + " has " + found;
  }
  return x && z ? sign : std::string();
}

}  // namespace kerf
