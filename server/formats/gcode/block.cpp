#include "server/formats/gcode/block.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "server/formats/gcode/expression.h"
#include "server/formats/gcode/fault.h"

namespace kerf {
namespace {

struct KnownCode {
  int code;
  GcodeGroup group;
};

constexpr std::array kGCodes{
    KnownCode{0, GcodeGroup::kMotion},
    KnownCode{10, GcodeGroup::kMotion},
    KnownCode{20, GcodeGroup::kMotion},
    KnownCode{30, GcodeGroup::kMotion},
    KnownCode{800, GcodeGroup::kMotion},
    KnownCode{40, GcodeGroup::kNonModal},
    KnownCode{100, GcodeGroup::kNonModal},
    KnownCode{280, GcodeGroup::kNonModal},
    KnownCode{300, GcodeGroup::kNonModal},
    KnownCode{530, GcodeGroup::kNonModal},
    KnownCode{920, GcodeGroup::kNonModal},
    KnownCode{921, GcodeGroup::kNonModal},
    KnownCode{922, GcodeGroup::kNonModal},
    KnownCode{923, GcodeGroup::kNonModal},
    KnownCode{170, GcodeGroup::kPlane},
    KnownCode{180, GcodeGroup::kPlane},
    KnownCode{190, GcodeGroup::kPlane},
    KnownCode{900, GcodeGroup::kDistance},
    KnownCode{910, GcodeGroup::kDistance},
    KnownCode{901, GcodeGroup::kArcDistance},
    KnownCode{911, GcodeGroup::kArcDistance},
    KnownCode{930, GcodeGroup::kFeedMode},
    KnownCode{940, GcodeGroup::kFeedMode},
    KnownCode{950, GcodeGroup::kFeedMode},
    KnownCode{200, GcodeGroup::kUnits},
    KnownCode{210, GcodeGroup::kUnits},
    KnownCode{400, GcodeGroup::kCutterCompensation},
    KnownCode{430, GcodeGroup::kToolLength},
    KnownCode{434, GcodeGroup::kToolLength},
    KnownCode{490, GcodeGroup::kToolLength},
    KnownCode{980, GcodeGroup::kRetract},
    KnownCode{990, GcodeGroup::kRetract},
    KnownCode{540, GcodeGroup::kCoordinateSystem},
    KnownCode{550, GcodeGroup::kCoordinateSystem},
    KnownCode{560, GcodeGroup::kCoordinateSystem},
    KnownCode{570, GcodeGroup::kCoordinateSystem},
    KnownCode{580, GcodeGroup::kCoordinateSystem},
    KnownCode{590, GcodeGroup::kCoordinateSystem},
    KnownCode{591, GcodeGroup::kCoordinateSystem},
    KnownCode{592, GcodeGroup::kCoordinateSystem},
    KnownCode{593, GcodeGroup::kCoordinateSystem},
    KnownCode{610, GcodeGroup::kPathControl},
    KnownCode{611, GcodeGroup::kPathControl},
    KnownCode{640, GcodeGroup::kPathControl},
    KnownCode{970, GcodeGroup::kSpindleMode},
};

constexpr std::array kMCodes{
    KnownCode{0, GcodeGroup::kStop},      KnownCode{1, GcodeGroup::kStop},
    KnownCode{2, GcodeGroup::kStop},      KnownCode{30, GcodeGroup::kStop},
    KnownCode{60, GcodeGroup::kStop},     KnownCode{6, GcodeGroup::kToolChange},
    KnownCode{3, GcodeGroup::kSpindle},   KnownCode{4, GcodeGroup::kSpindle},
    KnownCode{5, GcodeGroup::kSpindle},   KnownCode{7, GcodeGroup::kCoolant},
    KnownCode{8, GcodeGroup::kCoolant},   KnownCode{9, GcodeGroup::kCoolant},
    KnownCode{48, GcodeGroup::kOverride}, KnownCode{49, GcodeGroup::kOverride},
    KnownCode{428, GcodeGroup::kTcp},     KnownCode{429, GcodeGroup::kTcp},
};

constexpr std::string_view kValueLetters = "abcdfhijklpqrstxyz";

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

GcodeGroup group_of(char letter, int code, const std::string& text) {
  const auto search = [&](const auto& known) {
    const auto it = std::find_if(known.begin(), known.end(),
                                 [code](const KnownCode& k) { return k.code == code; });
    if (it == known.end()) throw GcodeFault{text, "is not a code that Kerf understands"};
    return it->group;
  };
  return letter == 'g' ? search(kGCodes) : search(kMCodes);
}

class BlockParser {
 public:
  BlockParser(std::string_view line, GcodeParameters& parameters)
      : reader_(line, parameters), parameters_(parameters) {}

  GcodeBlock parse() {
    if (reader_.peek() == '/') {
      block_.deleted = true;
      return std::move(block_);
    }
    if (reader_.peek() == 'n') line_number();
    while (!reader_.done()) item();
    for (const auto& [key, value] : assignments_)
      std::visit([&, v = value](const auto& k) { parameters_.set(k, v); }, key);
    return std::move(block_);
  }

 private:
  void line_number() {
    const std::size_t start = reader_.position();
    reader_.skip();
    const char first = reader_.peek();
    if ((first < '0' || first > '9') && first != '.')
      throw GcodeFault{upper(reader_.text_since(start)), "a line number is missing after N"};
    reader_.value();
  }

  void item() {
    const char letter = reader_.peek();
    if (letter == '#') return assignment();
    if (letter == 'g' || letter == 'm') return code(letter);
    if (kValueLetters.find(letter) != std::string_view::npos) return word(letter);
    throw GcodeFault{std::string(1, letter), why_not(letter)};
  }

  static std::string why_not(char letter) {
    if (letter == 'o') return "O words (subroutines, loops, branches) are not supported";
    if (letter == 'n') return "a line number may only stand at the beginning of a line";
    if (letter == 'u' || letter == 'v' || letter == 'w') return "there is no such axis";
    if (letter == '%') return "may only stand alone on a line";
    if (letter == '/') return "block delete may only stand at the beginning of a line";
    return "does not begin a word of G-code";
  }

  void assignment() {
    const std::size_t start = reader_.position();
    reader_.skip();
    auto key = reader_.parameter_key();
    const std::string text = reader_.text_since(start);
    if (reader_.peek() != '=')
      throw GcodeFault{text, "a parameter at the start of a word needs '='"};
    reader_.skip();
    const int* number = std::get_if<int>(&key);
    if (number != nullptr && *number >= kGcodeMachineFirst && *number <= kGcodeMachineLast)
      throw GcodeFault{text, "is kept by the machine; use G10 or G92 to move an origin"};
    const double value = reader_.value();
    assignments_.emplace_back(std::move(key), value);
  }

  void code(char letter) {
    const std::size_t start = reader_.position();
    reader_.skip();
    const double value = reader_.value();
    const std::string text = upper(reader_.text_since(start));
    const double scaled = letter == 'g' ? value * 10 : value;
    if (value < 0 || !is_gcode_integer(scaled)) throw GcodeFault{text, "is not a code"};
    const GcodeCode code{static_cast<int>(std::lround(scaled)), text};
    const GcodeGroup group = group_of(letter, code.code, text);
    if (const GcodeCode* other = block_.code(group))
      throw GcodeFault{
          text, "may not stand with " + other->text + " in one block: both are of one modal group"};
    block_.codes.emplace_back(group, code);
  }

  void word(char letter) {
    const std::size_t start = reader_.position();
    reader_.skip();
    const double value = reader_.value();
    const std::string text = upper(reader_.text_since(start));
    if (block_.find(letter) != nullptr)
      throw GcodeFault{
          text, std::string("is a second ") + upper(std::string(1, letter)) + " word in one block"};
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

bool takes_axis_words(int code) { return code == 100 || code == 280 || code == 300 || code == 920; }

std::string strip_gcode_line(std::string_view line) {
  std::string text;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == ';') break;
    if (c == '(') {
      const std::size_t end = line.find(')', i);
      if (end == std::string_view::npos)
        throw GcodeFault{std::string(line.substr(i)), "a comment does not end on its line"};
      const std::string_view comment = line.substr(i, end - i);
      if (comment.find('(', 1) != std::string_view::npos)
        throw GcodeFault{std::string(comment), "a comment may not stand within a comment"};
      i = end;
      continue;
    }
    if (c == ')') throw GcodeFault{")", "closes a comment that was not opened"};
    if (c == ' ' || c == '\t' || c == '\r') continue;
    text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

GcodeBlock parse_gcode_block(std::string_view line, GcodeParameters& parameters) {
  const std::string text = strip_gcode_line(line);
  return BlockParser(text, parameters).parse();
}

}  // namespace kerf
