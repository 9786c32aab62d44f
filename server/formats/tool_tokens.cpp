// SPDX-License-Identifier: Apache-2.0
#include "server/formats/tool_tokens.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "server/formats/letter_case.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

bool is_word_letter(char c) { return c >= 'A' && c <= 'Z'; }

// The ASCII text of the letters 0xC0 to 0xFF of Latin-1, which are U+00C0 to U+00FF. "DIA " and
// "DEG" replace the signs of a diameter and of a degree.
std::string ascii_of_latin1(unsigned code) {
  static constexpr std::string_view kUpper[] = {
      "A", "A", "A", "A", "AE", "A", "AE", "C", "E",     "E", "E", "E", "I",  "I", "I",  "I",
      "D", "N", "O", "O", "O",  "O", "OE", "X", " DIA ", "U", "U", "U", "UE", "Y", "TH", "SS"};
  if (code == 0xB0 || code == 0xBA) return " DEG ";
  if (code < 0xC0 || code > 0xFF) return "?";
  if (code == 0xF7) return "/";
  if (code == 0xFF) return "Y";
  return std::string(kUpper[(code - 0xC0) % 32]);
}

// The text in upper case without letters outside of ASCII.
std::string folded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0U;
    const bool continued = (next & 0xC0U) == 0x80U;
    if (byte < 0x80) {
      result += to_upper(text[i]);
    } else if ((byte == 0xC2 || byte == 0xC3) && continued) {
      result += ascii_of_latin1(((byte & 3U) << 6U) | (next & 0x3FU));
      ++i;
    } else if (text.substr(i).starts_with("\xE2\x8C\x80") ||
               text.substr(i).starts_with("\xE2\x88\x85")) {
      result += " DIA ";  // the signs of a diameter and of the empty set
      i += 2;
    } else {
      result += ascii_of_latin1(byte);
    }
  }
  return result;
}

/// Fewest digits of a counter after a name.
constexpr std::size_t kSerialDigits = 3;

class ToolTokens {
 public:
  explicit ToolTokens(std::string_view text)
      : text_(folded(text)), list_(text_.find("TOOL/") != std::string::npos) {
    while (at_ < text_.size()) next();
  }
  std::vector<ToolToken> take() { return std::move(tokens_); }

 private:
  char at(std::size_t i) const { return i < text_.size() ? text_[i] : '\0'; }

  void next() {
    const char c = at(at_);
    if (is_word_letter(c)) return word();
    if (is_digit(c) || (c == '.' && is_digit(at(at_ + 1)) && !abbreviates())) return number();
    if (c != ' ' && c != '\t') tokens_.push_back({.word = std::string(1, c), .glued = glued()});
    ++at_;
  }

  void word() {
    const std::size_t from = at_;
    const bool is_glued = glued();
    while (is_word_letter(at(at_))) ++at_;
    tokens_.push_back({.word = text_.substr(from, at_ - from), .glued = is_glued});
  }

  // The point of "NO.7" belongs to the word.
  bool abbreviates() const {
    return !tokens_.empty() && glued() &&
           (tokens_.back().word == "NO" || tokens_.back().word == "NR");
  }

  bool glued() const { return at_ > 0 && at(at_ - 1) != ' ' && at(at_ - 1) != '\t'; }

  double digits() {
    const std::size_t from = at_;
    while (is_digit(at(at_))) ++at_;
    const bool comma = is_decimal_comma();
    if (at(at_) == '.' || comma) ++at_;
    while (is_digit(at(at_))) ++at_;
    std::string text = text_.substr(from, at_ - from);
    std::ranges::replace(text, ',', '.');
    return std::strtod(text.c_str(), nullptr);
  }

  // Whether this is a single comma between digits, not one of a list ("6,0,20", TOOL/MILL,6,0).
  bool is_decimal_comma() const {
    if (list_ || at(at_) != ',' || !is_digit(at(at_ + 1))) return false;
    std::size_t end = at_ + 1;
    while (is_digit(at(end))) ++end;
    const bool ends =
        at(end) != '.' && at(end) != '/' && !(at(end) == ',' && is_digit(at(end + 1)));
    std::size_t begin = at_;
    while (begin > 0 && is_digit(at(begin - 1))) --begin;
    return ends && (begin == 0 || at(begin - 1) != ',');
  }

  // Whether the last token is the 1 of "1 1/4", not the number of a tool, as in "T1 1/4".
  bool is_whole_before() const {
    const std::size_t n = tokens_.size();
    if (n == 0 || !tokens_[n - 1].whole) return false;
    if (n == 1) return true;
    const std::string_view before = tokens_[n - 2].word;
    const auto numbers = {"T", "TOOL", "NO", "NR", "NUMBER", "H"};
    return !tokens_[n - 2].is_number() && std::ranges::find(numbers, before) == numbers.end();
  }

  // 6, 6.35, 6,35, .25, 1/4, 1-1/4 and 1 1/4, each with its unit.
  void number() {
    ToolToken token;
    const std::size_t from = at_;
    token.glued = glued();
    token.value = digits();
    token.serial = from > 0 && is_word_letter(at(from - 1)) && at(from) == '0' &&
                   at_ - from >= kSerialDigits && token.value == std::floor(token.value);
    const bool begins =
        from == 0 || std::string_view(" \t=:-(").find(at(from - 1)) != std::string_view::npos;
    token.whole = begins && (at(at_) == ' ' || at(at_) == '\t') && token.value >= 1 &&
                  token.value == std::floor(token.value);
    if (at(at_) == '/' && is_digit(at(at_ + 1))) {
      ++at_;
      double divisor = 0;
      for (; is_digit(at(at_)); ++at_) divisor = 10 * divisor + (at(at_) - '0');
      token.value = divisor > 0 ? token.value / divisor : 0;
      token.unit_mm = kMmPerInch;
      const std::size_t n = tokens_.size();
      if (n >= 2 && tokens_[n - 1].word == "-" && tokens_[n - 2].is_number()) {
        token.value += tokens_[n - 2].value;
        tokens_.resize(n - 2);
      } else if (token.value < 1 && is_whole_before()) {
        token.value += tokens_[n - 1].value;
        tokens_.pop_back();
      }
      token.whole = false;
    }
    unit(token);
    token.whole = token.whole && token.unit_mm == 0 && !token.degrees;
    tokens_.push_back(token);
  }

  void unit(ToolToken& token) {
    std::size_t from = at_;
    while (at(from) == ' ') ++from;
    if (at(from) == '"' || (at(from) == '\'' && at(from + 1) == '\'')) {
      token.unit_mm = kMmPerInch;
      at_ = from + (at(from) == '"' ? 1 : 2);
      return;
    }
    std::size_t end = from;
    while (is_word_letter(at(end))) ++end;
    const std::string word = text_.substr(from, end - from);
    const auto is_one_of = [&](std::initializer_list<std::string_view> units) {
      return std::ranges::find(units, std::string_view(word)) != units.end();
    };
    token.degrees = is_one_of({"DEG", "DEGREE", "DEGREES", "GRAD", "DEGRES", "DEGRE", "GRADOS"});
    const bool mm = is_one_of({"MM", "MILLIMETER", "MILLIMETERS", "MILLIMETRES"});
    const bool inch =
        is_one_of({"IN", "INCH", "INCHES", "ZOLL", "POUCE", "POUCES", "PULGADA", "PULGADAS"});
    if (mm || inch) token.unit_mm = mm ? 1 : kMmPerInch;
    if (mm || inch || token.degrees) at_ = end;
  }

  std::string text_;
  bool list_;  ///< commas separate numbers
  std::size_t at_ = 0;
  std::vector<ToolToken> tokens_;
};

}  // namespace

std::vector<ToolToken> tool_tokens(std::string_view words) { return ToolTokens(words).take(); }

}  // namespace kerf
