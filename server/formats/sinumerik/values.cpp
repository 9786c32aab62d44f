// SPDX-License-Identifier: Apache-2.0
#include "server/formats/sinumerik/values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "server/formats/control/fault.h"
#include "server/formats/letter_case.h"
#include "server/formats/number_text.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

/// Deepest nesting of parentheses, signs and indices.
constexpr int kNestingMax = 100;
/// Greatest number of an R parameter.
constexpr double kParameterMax = 99'999;
constexpr double kEqual = 1e-9;

bool begins_name(char c) { return (c >= 'A' && c <= 'Z') || c == '_' || c == '$'; }

class Formula {
 public:
  Formula(std::string_view text, std::size_t at, const SinumerikValues& values,
          const std::map<std::string, double>& known)
      : text_(text), at_(at), values_(values), known_(known) {}

  std::size_t at() const { return at_; }

  double comparison() {
    double left = disjunction();
    while (true) {
      const std::string_view sign = accept_any({"==", "<>", "<=", ">=", "<", ">"});
      if (sign.empty()) return left;
      const double right = disjunction();
      const bool same = std::abs(left - right) <= kEqual * std::max(1.0, std::abs(left));
      left = sign == "=="   ? same
             : sign == "<>" ? !same
             : sign == "<=" ? left < right || same
             : sign == ">=" ? left > right || same
             : sign == "<"  ? left < right && !same
                            : left > right && !same;
    }
  }

 private:
  double disjunction() {
    double left = conjunction();
    while (true) {
      const std::string_view word = accept_word({"OR", "XOR"});
      if (word.empty()) return left;
      const bool a = left != 0, b = conjunction() != 0;
      left = word == "OR" ? a || b : a != b;
    }
  }
  double conjunction() {
    double left = sum();
    while (!accept_word({"AND"}).empty()) {
      const bool right = sum() != 0;
      left = left != 0 && right;
    }
    return left;
  }
  double sum() {
    double left = product();
    while (true) {
      const std::string_view sign = accept_any({"+", "-"});
      if (sign.empty()) return left;
      const double right = product();
      left = sign == "+" ? left + right : left - right;
    }
  }
  double product() {
    double left = factor();
    while (true) {
      std::string_view sign = accept_any({"*", "/"});
      if (sign.empty()) sign = accept_word({"DIV", "MOD"});
      if (sign.empty()) return left;
      const double right = factor();
      if (sign != "*" && right == 0) throw ProgramFault{std::string(text_), "divides by 0"};
      left = sign == "*"     ? left * right
             : sign == "/"   ? left / right
             : sign == "DIV" ? std::trunc(left / right)
                             : std::fmod(left, right);
    }
  }
  double factor() {
    if (++depth_ > kNestingMax) throw ProgramFault{std::string(text_), "is nested too deeply"};
    const double value = signed_value();
    --depth_;
    if (!std::isfinite(value)) throw ProgramFault{std::string(text_), "has no finite value"};
    return value;
  }
  double signed_value() {
    const std::string_view sign = accept_any({"+", "-"});
    if (!sign.empty()) return sign == "-" ? -factor() : factor();
    if (!accept_word({"NOT"}).empty()) return factor() == 0;
    if (!accept_any({"("}).empty()) {
      const double inner = comparison();
      expect(")");
      return inner;
    }
    skip();
    if (at_ < text_.size() && begins_name(text_[at_])) return named();
    return number();
  }
  double number() {
    const char* const end = text_.data() + text_.size();
    double value = 0;
    const auto read = number_of_chars(text_.data() + at_, end, value, std::chars_format::fixed);
    if (read.ec != std::errc()) throw ProgramFault{rest(), "is not a number or an expression"};
    at_ = static_cast<std::size_t>(read.ptr - text_.data());
    if (text_.substr(at_).starts_with("EX")) {
      at_ += 2;
      value *= std::pow(10.0, signed_value());
    }
    return value;
  }
  double named() {
    std::size_t end = at_;
    while (end < text_.size() && is_sinumerik_name(text_[end])) ++end;
    std::string name(text_.substr(at_, end - at_));
    at_ = end;
    if (name == "TRUE") return 1;
    if (name == "FALSE") return 0;
    if (name == "$PI") return std::numbers::pi;
    if (name == "R" && !accept_any({"["}).empty()) {
      const double index = comparison();
      expect("]");
      if (!(index >= 0 && index <= kParameterMax && index == std::floor(index)))
        throw ProgramFault{"R[" + decimal_text(index, 6) + "]", "is not a number of a parameter"};
      name += decimal_text(index, 0);
    }
    if (at_ < text_.size() && text_[at_] == '(') return function(name);
    const auto it = known_.find(name);
    if (it != known_.end()) return it->second;
    if (values_.has(name)) return 0;
    throw ProgramFault{name, name.starts_with('$')
                                 ? "is a system variable, whose value is not known here"
                                 : "is not a variable of the program"};
  }
  std::vector<double> arguments() {
    std::vector<double> values;
    expect("(");
    do values.push_back(comparison());
    while (!accept_any({","}).empty());
    expect(")");
    return values;
  }
  double function(const std::string& name) {
    const std::vector<double> x = arguments();
    if (x.size() == 2) {
      if (name == "ATAN2") return kDegPerRad * std::atan2(x[0], x[1]);
      if (name == "MINVAL") return std::min(x[0], x[1]);
      if (name == "MAXVAL") return std::max(x[0], x[1]);
    }
    if (x.size() == 1) {
      const double v = x[0];
      if (name == "SIN") return std::sin(kRadPerDeg * v);
      if (name == "COS") return std::cos(kRadPerDeg * v);
      if (name == "TAN") return std::tan(kRadPerDeg * v);
      if (name == "ASIN") return kDegPerRad * std::asin(v);
      if (name == "ACOS") return kDegPerRad * std::acos(v);
      if (name == "SQRT") return std::sqrt(v);
      if (name == "POT") return v * v;
      if (name == "ABS") return std::abs(v);
      if (name == "TRUNC") return std::trunc(v);
      if (name == "ROUND") return std::floor(v + 0.5);
      if (name == "LN") return std::log(v);
      if (name == "EXP") return std::exp(v);
    }
    throw ProgramFault{name, "is not a supported function of " + std::to_string(x.size()) +
                                 (x.size() == 1 ? " value" : " values")};
  }

  void skip() { at_ = skip_blanks(text_, at_); }
  std::string rest() const { return std::string(text_.substr(std::min(at_, text_.size()))); }
  std::string_view accept_any(std::initializer_list<std::string_view> signs) {
    skip();
    for (const std::string_view sign : signs)
      if (text_.substr(at_).starts_with(sign)) return at_ += sign.size(), sign;
    return {};
  }
  std::string_view accept_word(std::initializer_list<std::string_view> words) {
    skip();
    for (const std::string_view word : words) {
      const std::size_t end = at_ + word.size();
      if (!text_.substr(at_).starts_with(word)) continue;
      if (end < text_.size() && is_sinumerik_name(text_[end])) continue;
      return at_ = end, word;
    }
    return {};
  }
  void expect(std::string_view sign) {
    if (accept_any({sign}).empty())
      throw ProgramFault{std::string(text_), "lacks '" + std::string(sign) + "'"};
  }

  std::string_view text_;
  std::size_t at_;
  const SinumerikValues& values_;
  const std::map<std::string, double>& known_;
  int depth_ = 0;
};

}  // namespace

bool is_sinumerik_name(char c) { return begins_name(c) || is_digit(c); }

bool begins_word(std::string_view text, std::string_view word) {
  return text.starts_with(word) &&
         (text.size() == word.size() || !is_sinumerik_name(text[word.size()]));
}

std::size_t skip_blanks(std::string_view text, std::size_t at) {
  while (at < text.size() && text[at] == ' ') ++at;
  return at;
}

bool SinumerikValues::has(const std::string& name) const {
  if (values_.contains(name)) return true;
  return name.size() > 1 && name[0] == 'R' && name.size() <= 6 &&
         std::all_of(name.begin() + 1, name.end(), is_digit);
}

double SinumerikValues::expression(std::string_view text, std::size_t& at) const {
  Formula formula(text, at, *this, values_);
  const double value = formula.comparison();
  at = formula.at();
  return value;
}

double SinumerikValues::of(std::string_view text) const {
  std::size_t at = 0;
  const double value = expression(text, at);
  if (skip_blanks(text, at) < text.size())
    throw ProgramFault{std::string(text.substr(at)), "is not part of an expression"};
  return value;
}

}  // namespace kerf
