// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/o_word.h"

#include <array>
#include <cctype>
#include <cmath>
#include <string_view>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/expression.h"
#include "server/formats/letter_case.h"

namespace kerf {
namespace {

using Keyword = OWord::Keyword;

struct Known {
  std::string_view word;
  Keyword keyword;
};
// The first match counts, so no keyword may precede a longer one that begins with it.
constexpr std::array kKeywords{Known{"sub", Keyword::kSub},
                               Known{"endsub", Keyword::kEndsub},
                               Known{"call", Keyword::kCall},
                               Known{"return", Keyword::kReturn},
                               Known{"do", Keyword::kDo},
                               Known{"while", Keyword::kWhile},
                               Known{"endwhile", Keyword::kEndwhile},
                               Known{"repeat", Keyword::kRepeat},
                               Known{"endrepeat", Keyword::kEndrepeat},
                               Known{"if", Keyword::kIf},
                               Known{"elseif", Keyword::kElseif},
                               Known{"else", Keyword::kElse},
                               Known{"endif", Keyword::kEndif},
                               Known{"break", Keyword::kBreak},
                               Known{"continue", Keyword::kContinue}};

// The code of a line without its line number.
std::string_view code_of(const GcodeLine& line) {
  std::string_view code = line.code;
  if (!code.starts_with('n')) return code;
  const auto end = code.find_first_not_of("0123456789.", 1);
  return end == std::string_view::npos ? std::string_view() : code.substr(end);
}

bool is_m(std::string_view code, std::string_view number) {
  return code.starts_with('m') && code.substr(1).starts_with(number) &&
         (code.size() == 3 || std::isdigit(static_cast<unsigned char>(code[3])) == 0);
}

OWord read_m98(GcodeValueReader& reader, bool with_values) {
  OWord word{.keyword = Keyword::kM98, .name = {}, .text = "M98", .values = {}};
  while (with_values && !reader.done()) {
    const char letter = reader.peek();
    reader.skip();
    if (letter == 'p') {
      word.name = std::to_string(reader.integer("the number of a program"));
    } else if (letter == 'l') {
      word.repeats = reader.integer("the number of calls");
      if (word.repeats < 0) throw ProgramFault{"L", "must not be negative"};
    } else {
      throw ProgramFault{std::string(1, letter),
                         "is not allowed with M98, which takes P and L only"};
    }
  }
  if (with_values && word.name.empty())
    throw ProgramFault{"M98", "requires P, the number of the program to call"};
  return word;
}

// Reads the values in brackets after the keyword.
void read_values(GcodeValueReader& reader, OWord& word) {
  const bool condition = word.keyword == Keyword::kWhile || word.keyword == Keyword::kIf ||
                         word.keyword == Keyword::kElseif || word.keyword == Keyword::kRepeat;
  const bool returns = word.keyword == Keyword::kReturn || word.keyword == Keyword::kEndsub;
  const std::size_t most = word.keyword == Keyword::kCall ? kGcodeLocalParameters
                           : condition || returns         ? 1
                                                          : 0;
  while (reader.peek() == '[') {
    if (word.values.size() == most)
      throw ProgramFault{word.text, "takes at most " + std::to_string(most) + " values"};
    word.values.push_back(reader.bracket());
    if (!std::isfinite(word.values.back())) throw ProgramFault{word.text, "has no finite value"};
  }
  if (condition && word.values.empty())
    throw ProgramFault{word.text, "requires a value in brackets"};
  if (!reader.done()) throw ProgramFault{word.text, "must not be followed by other words"};
}

}  // namespace

bool is_o_word(const GcodeLine& line, bool within_subroutine) {
  const std::string_view code = code_of(line);
  return code.starts_with('o') || is_m(code, "98") || (within_subroutine && is_m(code, "99"));
}

OWord read_o_word(const GcodeLine& line, const OWordContext& context, bool with_values) {
  const std::string_view code = code_of(line);
  GcodeValueReader reader(code, context.parameters, context.position_readable);
  if (is_m(code, "99")) return {.keyword = Keyword::kM99, .name = {}, .text = "M99", .values = {}};
  const bool m98 = is_m(code, "98");
  for (int i = 0; i < (m98 ? 3 : 1); ++i) reader.skip();
  if (m98) return read_m98(reader, with_values);
  OWord word;
  if (reader.peek() == '<') {
    reader.skip();
    word.name = reader.name();
  } else {
    word.name = std::to_string(reader.integer("the number of an O word"));
  }
  const std::string label = to_upper(reader.text_since(0));
  if (reader.done()) {
    word.keyword = Keyword::kProgram;
    word.text = label;
    return word;
  }
  for (const Known& known : kKeywords) {
    if (!reader.accept(known.word)) continue;
    word.keyword = known.keyword;
    word.text = label + " " + to_upper(std::string(known.word));
    if (with_values) read_values(reader, word);
    return word;
  }
  throw ProgramFault{label, "must be followed by a control flow keyword (sub, call, if, while, …)"};
}

}  // namespace kerf
