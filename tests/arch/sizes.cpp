// SPDX-License-Identifier: Apache-2.0
#include "tests/arch/sizes.h"

#include <algorithm>
#include <cctype>
#include <regex>
#include <string>
#include <string_view>

namespace kerf::arch {
namespace {

// Counts columns as an editor does: a UTF-8 sequence is one.
std::size_t columns_of(std::string_view line) {
  std::size_t columns = 0;
  for (const char c : line) columns += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return columns;
}

// Returns true if the line is part of a raw literal, which must not be broken.
bool holds_raw_literal(std::string_view line, std::string_view code) {
  const bool comment = line.find("//") != line.npos;
  const bool inside = code.find_first_not_of(' ') == code.npos;
  const bool ends = line.find("R\"") != line.npos || line.find(")\"") != line.npos;
  return ends || (inside && !comment);
}

bool opens_initializer(std::string_view code, std::size_t brace) {
  if (brace == 0) return false;
  const char before = code[brace - 1];
  return std::isalnum(static_cast<unsigned char>(before)) || before == '_' || before == '>';
}

// Returns true if the text before an opening brace outside any function is the head of a function
// or lambda.
bool heads_function(const std::string& head) {
  static const std::regex kScope(
      R"(^\s*(template\s*<[^{]*>\s*)?(namespace|class|struct|enum|union|extern)\b)");
  static const std::regex kValue(R"([^=!<>+\-*/]=\s*$)");
  return head.find('(') != head.npos && !std::regex_search(head, kScope) &&
         !std::regex_search(head, kValue);
}

std::size_t matching_brace(std::string_view code, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < code.size(); ++i) {
    if (code[i] == '{') ++depth;
    if (code[i] == '}' && --depth == 0) return i;
  }
  return code.size();
}

void check_functions(const Source& source, std::vector<Violation>& violations) {
  std::string code = code_only(source.text);
  for (std::size_t i = 0; i < code.size(); ++i) {  // directives are not part of declarations
    const bool directive = code[i] == '#' && (i == 0 || code[i - 1] == '\n');
    while (directive && i < code.size() && code[i] != '\n') code[i++] = ' ';
  }
  std::size_t head_begin = 0;
  for (std::size_t i = 0; i < code.size(); ++i) {
    if (code[i] == ';' || code[i] == '}') head_begin = i + 1;
    if (code[i] != '{') continue;
    if (opens_initializer(code, i)) {
      i = matching_brace(code, i);
      continue;
    }
    const std::string head = code.substr(head_begin, i - head_begin);
    head_begin = i + 1;
    if (!heads_function(head)) continue;
    const std::size_t end = matching_brace(code, i);
    const std::size_t first = line_at(code, i), last = line_at(code, end);
    if (last - first + 1 > kFunctionLinesMax) {
      violations.push_back({source.path, first,
                            "a function of " + std::to_string(last - first + 1) +
                                " lines; the limit is " + std::to_string(kFunctionLinesMax) +
                                ": split it"});
    }
    i = end;
    head_begin = end + 1;
  }
}

// Table rows, code blocks and lines without a space to break at may be longer.
std::vector<Violation> check_markdown(const Source& source) {
  std::vector<Violation> violations;
  bool code = false;
  std::size_t number = 0;
  for (const std::string_view line : lines_of(source.text)) {
    ++number;
    const std::string_view trimmed =
        line.substr(std::min(line.find_first_not_of(' '), line.size()));
    if (trimmed.starts_with("```")) code = !code;
    const bool exempt = code || trimmed.starts_with('|') || trimmed.starts_with("![") ||
                        trimmed.find(' ', 2) == trimmed.npos;
    if (exempt || columns_of(line) <= kColumnsMax) continue;
    violations.push_back(
        {source.path, number,
         std::to_string(columns_of(line)) + " columns; wrap at " + std::to_string(kColumnsMax)});
  }
  return violations;
}

}  // namespace

std::vector<Violation> check_sizes(const Source& source) {
  if (source.path.ends_with(".md")) return check_markdown(source);
  std::vector<Violation> violations;
  const bool cpp = is_cpp(source.path);
  if (!cpp && !is_typescript(source.path)) return violations;
  const auto lines = lines_of(source.text);
  const std::string code = code_only(source.text);
  const auto code_lines = lines_of(code);
  for (std::size_t i = 0; cpp && i < lines.size(); ++i) {
    if (columns_of(lines[i]) <= kColumnsMax || holds_raw_literal(lines[i], code_lines[i])) continue;
    violations.push_back({source.path, i + 1,
                          std::to_string(columns_of(lines[i])) + " columns; the limit is " +
                              std::to_string(kColumnsMax)});
  }
  if (lines.size() > kFileLinesMax) {
    violations.push_back({source.path, lines.size(),
                          std::to_string(lines.size()) + " lines; the limit is " +
                              std::to_string(kFileLinesMax) + ": one idea per file"});
  }
  if (cpp) check_functions(source, violations);
  return violations;
}

}  // namespace kerf::arch
