// SPDX-License-Identifier: Apache-2.0
#include "server/formats/stated_stock.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "server/formats/apt/statement.h"
#include "server/formats/letter_case.h"
#include "server/formats/text_lines.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr double kSideMaxMm = 10'000;
constexpr std::size_t kLinesMax = 5'000;

// The sides in a comment: numbers after X, Y and Z, or three numbers joined by "x" or commas.
class Sides {
 public:
  Sides(const std::string& text, double unit_mm) : text_(text), unit_mm_(unit_mm) {}

  std::optional<Vec3> size_mm() const {
    const auto x = behind('X'), y = behind('Y'), z = behind('Z');
    if (x && y && z) return checked({*x, *y, *z});
    std::size_t at = text_.find_first_of("0123456789.");
    double sides[3];
    for (int i = 0; i < 3; ++i) {
      if (at == std::string::npos) return std::nullopt;
      const bool negative = at > 0 && text_[at - 1] == '-';
      const auto side = number(at);
      if (!side || negative) return std::nullopt;
      sides[i] = *side;
      if (i == 2) break;
      while (at < text_.size() && text_[at] == ' ') ++at;
      if (at >= text_.size() || (text_[at] != 'X' && text_[at] != ',' && text_[at] != '*'))
        return std::nullopt;
      at = text_.find_first_of("0123456789.", at);
    }
    return checked({sides[0], sides[1], sides[2]});
  }

 private:
  static std::optional<Vec3> checked(Vec3 v) {
    for (const double side : {v.x, v.y, v.z})
      if (!(side > 0 && side <= kSideMaxMm)) return std::nullopt;
    return v;
  }

  std::optional<double> behind(char letter) const {
    for (std::size_t at = text_.find(letter); at != std::string::npos;
         at = text_.find(letter, at + 1)) {
      const bool joined = is_letter(at, 1) && (text_[at - 1] != 'D' || is_letter(at, 2));
      std::size_t from = at + 1;
      while (from < text_.size() &&
             (text_[from] == ' ' || text_[from] == '=' || text_[from] == ':'))
        ++from;
      if (!joined)
        if (const auto value = number(from)) return value;
    }
    return std::nullopt;
  }

  // Whether the character so many places before a place is a letter. "DX" is the side along X.
  bool is_letter(std::size_t at, std::size_t before) const {
    return at >= before && text_[at - before] >= 'A' && text_[at - before] <= 'Z';
  }

  std::optional<double> number(std::size_t& at) const {
    char* end = nullptr;
    const char* const from = text_.c_str() + at;
    if (!is_digit(*from) && *from != '.') return std::nullopt;
    std::size_t digits = 0;
    while (is_digit(from[digits]) || from[digits] == '.') ++digits;
    const double value = std::strtod(std::string(from, digits).c_str(), &end);
    at += digits;
    std::size_t unit = at;
    while (unit < text_.size() && text_[unit] == ' ') ++unit;
    if (text_.compare(unit, 2, "MM") == 0) return at = unit + 2, value;
    if (text_.compare(unit, 2, "IN") == 0) return at = unit + 2, value * kMmPerInch;
    if (text_.compare(unit, 1, "\"") == 0) return at = unit + 1, value * kMmPerInch;
    return value * unit_mm_;
  }

  const std::string& text_;
  double unit_mm_;
};

bool names_stock(const std::string& upper) {
  for (const char* word :
       {"STOCK", "MATERIAL SIZE", "MATERIAL:", "WORKPIECE", "BLANK", "BLOCK SIZE"})
    if (upper.find(word) != std::string::npos) return true;
  return false;
}

// Start of a line's comment, or npos. In APT comments follow $$ and are in texts.
std::size_t comment_begin(const std::string& upper, bool apt) {
  if (!apt) {
    const std::size_t begin = upper.find_first_of("(;");
    return begin == std::string::npos ? begin : begin + 1;
  }
  const std::size_t word = std::min(upper.find_first_not_of(" \t"), upper.size());
  for (const std::string_view text : {"INSERT", "PPRINT", "REMARK", "$$"})
    if (std::string_view(upper).substr(word).starts_with(text)) return word + text.size();
  return std::string::npos;
}

}  // namespace

std::optional<StatedStock> stated_stock(std::string_view program, double unit_mm) {
  const bool apt = is_apt(program);
  TextLines walk(program);
  bool title = false;  // the previous line names the stock without a size
  while (walk.next() && walk.number() <= kLinesMax) {
    const std::string upper = to_upper(std::string(walk.line()));
    const std::size_t begin = comment_begin(upper, apt);
    if (begin == std::string::npos) continue;
    const std::string comment = upper.substr(begin);
    const bool named = names_stock(comment);
    if (named || title)
      if (const auto size = Sides(comment, unit_mm).size_mm())
        return StatedStock{*size, walk.number()};
    title = named;
  }
  return std::nullopt;
}

}  // namespace kerf
