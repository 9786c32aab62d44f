// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/block.h"

#include <algorithm>
#include <cmath>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/expression.h"
#include "server/formats/letter_case.h"

namespace kerf {
namespace {

constexpr std::string_view kValueLetters = "abcdefhijklpqrstxyz@^$";
// Macro B: #3000=1 raises an alarm, #3006=1 stops with a message.
constexpr int kAlarm = 3000, kMessage = 3006;
constexpr int kDwell = 40;

class BlockParser {
 public:
  BlockParser(std::string_view line, GcodeParameters& parameters, bool position_readable,
              const DialectRules& rules)
      : reader_(line, parameters, position_readable), parameters_(parameters), rules_(rules) {}

  GcodeBlock parse() {
    if (reader_.peek() == 'n') line_number();
    while (!reader_.done()) item();
    for (const GcodeWord& word : block_.words)
      if (word.empty && !goes_home()) throw ProgramFault{word.text, "requires a value"};
    for (const auto& [key, value] : assignments_)
      std::visit([&, v = value](const auto& k) { parameters_.set(k, v); }, key);
    return std::move(block_);
  }

 private:
  void line_number() {
    const std::size_t start = reader_.position();
    reader_.begin_word();
    reader_.skip();
    const char first = reader_.peek();
    if ((first < '0' || first > '9') && first != '.')
      throw ProgramFault{to_upper(reader_.text_since(start)), "requires a line number"};
    reader_.value();
  }

  void item() {
    reader_.begin_word();
    const char letter = reader_.peek();
    if (letter == '#') return assignment();
    if (rules_.macros && item_of_macros(letter)) return;
    if (letter == 'g' || letter == 'm') return code(letter);
    if (kValueLetters.find(letter) != std::string_view::npos) return word(letter);
    throw ProgramFault{std::string(1, letter), invalid_letter_reason(letter)};
  }

  // Reads the items that controls allow beyond LinuxCNC: line numbers anywhere, block delete within
  // the block, corners, codes separated by '*' or ';'.
  bool item_of_macros(char letter) {
    if (letter == 'n') {
      line_number();
      return true;
    }
    if (letter == '/') {
      while (!reader_.done()) reader_.skip();
      return true;
    }
    if (letter == 'u' && block_.has_code(GcodeGroup::kNonModal, kDwell)) {
      word(letter);
      return true;
    }
    if (letter != ',') return false;
    reader_.skip();
    const char kind = reader_.peek();
    if (kind != 'r' && kind != 'c') throw ProgramFault{",", "must be ,R or ,C: a corner"};
    reader_.skip();
    const std::size_t start = reader_.position();
    const double value = reader_.value();
    const char key = kind == 'r' ? kCornerRadius : kCornerChamfer;
    if (block_.find(key) != nullptr) throw ProgramFault{",", "a block may have one corner"};
    block_.words.push_back(
        {key, value, std::string(",") + to_upper(kind) + to_upper(reader_.text_since(start))});
    return true;
  }

  bool goes_home() const {
    const GcodeCode* code = block_.code(GcodeGroup::kNonModal);
    return code != nullptr && (code->code == 280 || code->code == 300);
  }

  static std::string invalid_letter_reason(char letter) {
    if (letter == 'o') return "an O word is allowed at the beginning of a line only";
    if (letter == 'n') return "a line number is allowed at the beginning of a line only";
    if (letter == 'u' || letter == 'v' || letter == 'w')
      return "the axes U, V and W are not supported";
    if (letter == '%') return "must be alone on its line";
    if (letter == '/') return "block delete is allowed at the beginning of a line only";
    return "is not a word letter of G-code";
  }

  void assignment() {
    const std::size_t start = reader_.position();
    reader_.skip();
    auto key = reader_.parameter_key();
    const std::string text = reader_.text_since(start);
    if (reader_.peek() != '=')
      throw ProgramFault{text, "an assignment requires '=' after the parameter"};
    reader_.skip();
    const int* number = std::get_if<int>(&key);
    if (rules_.macros) return assign_macro(std::move(key), text);
    if (number != nullptr && !is_gcode_parameter_writable(*number))
      throw ProgramFault{text, "is read-only: it holds a state of the machine"};
    if (number == nullptr) parameters_.declare(std::get<std::string>(key));
    const double value = reader_.value();
    assignments_.emplace_back(std::move(key), value);
  }

  void assign_macro(std::variant<int, std::string> key, const std::string& text) {
    const int* number = std::get_if<int>(&key);
    if (number == nullptr) throw ProgramFault{text, "is a named variable, which is not supported"};
    const double value = reader_.expression();
    if (*number == kAlarm) throw ProgramFault{text, "the program raises an alarm here"};
    if (*number == kMessage) return;
    if (!is_macro_variable(*number, true))
      throw ProgramFault{text,
                         "is a system variable of the control, which cannot be assigned here"};
    assignments_.emplace_back(*number, value);
  }

  void code(char letter) {
    const std::size_t start = reader_.position();
    reader_.skip();
    const double value = reader_.value();
    const std::string text = to_upper(reader_.text_since(start));
    const double scaled = letter == 'g' ? value * 10 : value;
    if (value < 0 || !is_gcode_integer(scaled))
      throw ProgramFault{text, "is not a valid code number"};
    const GcodeCode code{static_cast<int>(std::lround(scaled)), text};
    const GcodeGroup group = gcode_group(letter, code.code, text, rules_);
    const bool keeps_all = group == GcodeGroup::kNoEffect || group == GcodeGroup::kUnknown;
    if (rules_.macros && group != GcodeGroup::kNonModal && !keeps_all && !merges(group, code))
      block_.drop(group);
    if (keeps_all) return block_.codes.emplace_back(group, code), void();
    if (group != GcodeGroup::kMotion || !merged_with_g80(code)) {
      if (const GcodeCode* other = block_.code(group))
        throw ProgramFault{
            text, "conflicts with " + other->text + ": a block may have one code of a modal group"};
      block_.codes.emplace_back(group, code);
    }
  }

  bool merges(GcodeGroup group, const GcodeCode& code) const {
    const GcodeCode* other = block_.code(group);
    return group == GcodeGroup::kMotion && other != nullptr &&
           (code.code == 800 || other->code == 800);
  }

  // G80 is replaced by another motion code of its block.
  bool merged_with_g80(const GcodeCode& code) {
    for (auto& [group, other] : block_.codes) {
      if (group != GcodeGroup::kMotion) continue;
      if (code.code == 800) return true;
      if (other.code != 800) return false;
      other = code;
      return true;
    }
    return false;
  }

  void word(char letter) {
    const std::size_t start = reader_.position();
    reader_.skip();
    const bool empty = rules_.macros && is_empty_word();
    const double value = empty ? 0 : reader_.value();
    const std::string text = to_upper(reader_.text_since(start));
    if (std::isnan(value)) return;  // a vacant variable: the word does not exist
    // T01T02M06 of Mazak: the second T prepares the next tool.
    if (rules_.macros && letter == 't' && block_.find('t') != nullptr) return;
    if (block_.find(letter) != nullptr)
      throw ProgramFault{text, "repeats the letter " + to_upper(std::string(1, letter)) +
                                   ": a block may have one word of each letter"};
    block_.words.push_back({letter, value, text, false, empty});
  }

  bool is_empty_word() const {
    const char next = reader_.peek();
    return reader_.done() || (next >= 'a' && next <= 'z' && !reader_.at_function());
  }

  GcodeValueReader reader_;
  GcodeParameters& parameters_;
  const DialectRules& rules_;
  GcodeBlock block_;
  std::vector<std::pair<std::variant<int, std::string>, double>> assignments_;
};

// Returns the text after M117 and M118 (Marlin: messages), and after M0 and M1 if it is words.
std::optional<std::string_view> message_of(std::string_view line) {
  std::size_t at = 0;
  const auto blanks = [&] {
    while (at < line.size() && (line[at] == ' ' || line[at] == '\t')) ++at;
  };
  const auto digits = [&] {
    const std::size_t from = at;
    while (at < line.size() && is_digit(line[at])) ++at;
    return line.substr(from, at - from);
  };
  blanks();
  if (at < line.size() && to_lower(line[at]) == 'n') ++at, digits(), blanks();
  if (at >= line.size() || to_lower(line[at]) != 'm') return std::nullopt;
  ++at;
  const std::string_view code = digits();
  const bool message = code == "117" || code == "118";
  const bool stop = code == "0" || code == "1" || code == "00" || code == "01";
  blanks();
  const auto is_letter = [&](std::size_t i) {
    return i < line.size() && to_lower(line[i]) >= 'a' && to_lower(line[i]) <= 'z';
  };
  if (message || (stop && is_letter(at) && is_letter(at + 1))) return line.substr(at);
  return std::nullopt;
}

// Comments in parentheses may be nested and unclosed. Surplus ')' are dropped.
GcodeLine split_nested(std::string_view line) {
  GcodeLine result;
  if (const auto message = message_of(line)) {
    result.comment = message->substr(0, message->find_last_not_of(" \t\r") + 1);
    return result;
  }
  int depth = 0;
  for (const char c : line) {
    if (c == '(' && depth++ == 0) {
      result.comment.clear();
    } else if (c == ')') {
      depth = std::max(depth - 1, 0);
    } else if (depth > 0) {
      result.comment += c;
    } else if (c == ';') {
      break;
    } else if (static_cast<unsigned char>(c) > ' ' || c == '\0') {
      result.code += to_lower(c);
    }
  }
  return result;
}

}  // namespace

const GcodeCode* GcodeBlock::code(GcodeGroup group) const {
  for (const auto& [g, code] : codes)
    if (g == group) return &code;
  return nullptr;
}

void GcodeBlock::drop(GcodeGroup group) {
  std::erase_if(codes, [group](const auto& entry) { return entry.first == group; });
}

bool GcodeBlock::has_code(GcodeGroup group, int code) const {
  const GcodeCode* found = this->code(group);
  return found != nullptr && found->code == code;
}

const GcodeWord* GcodeBlock::find(char letter) const {
  for (const GcodeWord& word : words)
    if (word.letter == letter) return &word;
  return nullptr;
}

std::optional<double> GcodeBlock::take(char letter) {
  for (GcodeWord& word : words) {
    if (word.letter != letter) continue;
    word.used = true;
    return word.empty ? std::nullopt : std::optional(word.value);
  }
  return std::nullopt;
}

bool GcodeBlock::has_any(std::string_view letters) const {
  return std::any_of(letters.begin(), letters.end(),
                     [this](char letter) { return find(letter) != nullptr; });
}

bool is_percent(std::string_view line) {
  const auto first = line.find_first_not_of(" \t\r");
  if (first == std::string_view::npos || line[first] != '%') return false;
  return line.find_first_not_of(" \t\r", first + 1) == std::string_view::npos;
}

GcodeLine split_gcode_line(std::string_view line, const DialectRules& rules) {
  if (rules.macros) return split_nested(line);
  GcodeLine result;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == ';') {
      if (result.code.empty() && line.substr(i + 1).starts_with("py,"))
        throw ProgramFault{";py,", "runs Python, which is not supported"};
      break;
    }
    if (c == '(') {
      const std::size_t end = line.find(')', i);
      if (end == std::string_view::npos)
        throw ProgramFault{std::string(line.substr(i)),
                           "the comment is not closed with ')' on its line"};
      result.comment = line.substr(i + 1, end - i - 1);
      if (result.comment.find('(') != std::string::npos)
        throw ProgramFault{"(" + result.comment, "a comment must not contain another comment"};
      i = end;
      continue;
    }
    if (c == ')') throw ProgramFault{")", "has no matching '('"};
    if (c == ' ' || c == '\t' || c == '\r') continue;
    result.code += to_lower(c);
  }
  return result;
}

GcodeBlock parse_gcode_block(std::string_view code, GcodeParameters& parameters,
                             bool position_readable, const DialectRules& rules) {
  return BlockParser(code, parameters, position_readable, rules).parse();
}

}  // namespace kerf
