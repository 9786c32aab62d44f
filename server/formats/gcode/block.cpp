// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/block.h"

#include <algorithm>
#include <cmath>

#include "server/formats/gcode/expression.h"
#include "server/formats/gcode/fault.h"
#include "server/formats/letter_case.h"

namespace kerf {
namespace {

constexpr std::string_view kValueLetters = "abcdefhijklpqrstxyz@^$";

class BlockParser {
 public:
  BlockParser(std::string_view line, GcodeParameters& parameters, bool position_readable)
      : reader_(line, parameters, position_readable), parameters_(parameters) {}

  GcodeBlock parse() {
    if (reader_.peek() == 'n') line_number();
    while (!reader_.done()) item();
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
      throw GcodeFault{to_upper(reader_.text_since(start)), "requires a line number"};
    reader_.value();
  }

  void item() {
    reader_.begin_word();
    const char letter = reader_.peek();
    if (letter == '#') return assignment();
    if (letter == 'g' || letter == 'm') return code(letter);
    if (kValueLetters.find(letter) != std::string_view::npos) return word(letter);
    throw GcodeFault{std::string(1, letter), invalid_letter_reason(letter)};
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
      throw GcodeFault{text, "an assignment requires '=' after the parameter"};
    reader_.skip();
    const int* number = std::get_if<int>(&key);
    if (number != nullptr && !is_gcode_parameter_writable(*number))
      throw GcodeFault{text, "is read-only: it holds a state of the machine"};
    if (number == nullptr) parameters_.declare(std::get<std::string>(key));
    const double value = reader_.value();
    assignments_.emplace_back(std::move(key), value);
  }

  void code(char letter) {
    const std::size_t start = reader_.position();
    reader_.skip();
    const double value = reader_.value();
    const std::string text = to_upper(reader_.text_since(start));
    const double scaled = letter == 'g' ? value * 10 : value;
    if (value < 0 || !is_gcode_integer(scaled))
      throw GcodeFault{text, "is not a valid code number"};
    const GcodeCode code{static_cast<int>(std::lround(scaled)), text};
    const GcodeGroup group = gcode_group(letter, code.code, text);
    if (group != GcodeGroup::kMotion || !merged_with_g80(code)) {
      if (const GcodeCode* other = block_.code(group))
        throw GcodeFault{
            text, "conflicts with " + other->text + ": a block may have one code of a modal group"};
      block_.codes.emplace_back(group, code);
    }
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
    const double value = reader_.value();
    const std::string text = to_upper(reader_.text_since(start));
    if (block_.find(letter) != nullptr)
      throw GcodeFault{text, "repeats the letter " + to_upper(std::string(1, letter)) +
                                 ": a block may have one word of each letter"};
    block_.words.push_back({letter, value, text});
  }

  GcodeValueReader reader_;
  GcodeParameters& parameters_;
  GcodeBlock block_;
  std::vector<std::pair<std::variant<int, std::string>, double>> assignments_;
};

}  // namespace

const GcodeCode* GcodeBlock::code(GcodeGroup group) const {
  for (const auto& [g, code] : codes)
    if (g == group) return &code;
  return nullptr;
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
    return word.value;
  }
  return std::nullopt;
}

bool GcodeBlock::has_any(std::string_view letters) const {
  return std::any_of(letters.begin(), letters.end(),
                     [this](char letter) { return find(letter) != nullptr; });
}

GcodeLine split_gcode_line(std::string_view line) {
  GcodeLine result;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == ';') {
      if (result.code.empty() && line.substr(i + 1).starts_with("py,"))
        throw GcodeFault{";py,", "runs Python, which is not supported"};
      break;
    }
    if (c == '(') {
      const std::size_t end = line.find(')', i);
      if (end == std::string_view::npos)
        throw GcodeFault{std::string(line.substr(i)),
                         "the comment is not closed with ')' on its line"};
      result.comment = line.substr(i + 1, end - i - 1);
      if (result.comment.find('(') != std::string::npos)
        throw GcodeFault{"(" + result.comment, "a comment must not contain another comment"};
      i = end;
      continue;
    }
    if (c == ')') throw GcodeFault{")", "has no matching '('"};
    if (c == ' ' || c == '\t' || c == '\r') continue;
    result.code += to_lower(c);
  }
  return result;
}

GcodeBlock parse_gcode_block(std::string_view code, GcodeParameters& parameters,
                             bool position_readable) {
  return BlockParser(code, parameters, position_readable).parse();
}

}  // namespace kerf
