// SPDX-License-Identifier: Apache-2.0
#include "server/formats/heidenhain/values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/formats/heidenhain/blocks.h"
#include "server/formats/letter_case.h"
#include "server/formats/number_text.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr int kNestingMax = 100;
constexpr std::size_t kParametersMax = 10'000;

using Function = double (*)(double);
constexpr std::array kFunctions{
    std::pair<std::string_view, Function>{"ASIN",
                                          [](double v) { return kDegPerRad * std::asin(v); }},
    std::pair<std::string_view, Function>{"ACOS",
                                          [](double v) { return kDegPerRad * std::acos(v); }},
    std::pair<std::string_view, Function>{"ATAN",
                                          [](double v) { return kDegPerRad * std::atan(v); }},
    std::pair<std::string_view, Function>{"SIN", [](double v) { return std::sin(kRadPerDeg * v); }},
    std::pair<std::string_view, Function>{"COS", [](double v) { return std::cos(kRadPerDeg * v); }},
    std::pair<std::string_view, Function>{"TAN", [](double v) { return std::tan(kRadPerDeg * v); }},
    std::pair<std::string_view, Function>{"SQRT", [](double v) { return std::sqrt(v); }},
    std::pair<std::string_view, Function>{"ABS", [](double v) { return std::abs(v); }},
    std::pair<std::string_view, Function>{"INT", [](double v) { return std::trunc(v); }},
    std::pair<std::string_view, Function>{"FRAC", [](double v) { return v - std::trunc(v); }},
    std::pair<std::string_view, Function>{"NEG", [](double v) { return -v; }},
    std::pair<std::string_view, Function>{"LOG", [](double v) { return std::log10(v); }},
    std::pair<std::string_view, Function>{"LN", [](double v) { return std::log(v); }},
    std::pair<std::string_view, Function>{"EXP", [](double v) { return std::exp(v); }},
    std::pair<std::string_view, Function>{"SGN", [](double v) {
                                            return v > 0 ? 1.0 : v < 0 ? -1.0 : 0.0;
                                          }}};

// Sums of products of powers. A function binds closer than a power.
class Formula {
 public:
  Formula(std::string_view text, const KlartextValues& values) : values_(values) {
    for (const char c : text)
      if (c != ' ') text_ += c == ',' ? '.' : c;
  }

  double value() {
    const double result = sum();
    if (at_ != text_.size()) throw ProgramFault{text_.substr(at_), "is not part of a formula"};
    if (!std::isfinite(result)) throw ProgramFault{text_, "has no finite value"};
    return result;
  }

 private:
  bool take(std::string_view word) {
    if (std::string_view(text_).substr(at_, word.size()) != word) return false;
    at_ += word.size();
    return true;
  }

  double sum() {
    if (++nesting_ > kNestingMax) throw ProgramFault{text_, "is nested too deep"};
    double result = product();
    while (true) {
      if (take("+")) {
        result += product();
      } else if (take("-")) {
        result -= product();
      } else {
        --nesting_;
        return result;
      }
    }
  }

  double product() {
    double result = power();
    while (true) {
      if (take("*")) {
        result *= power();
      } else if (take("/") || take("DIV")) {
        result /= power();
      } else if (take("LEN")) {
        result = std::hypot(result, power());
      } else {
        return result;
      }
    }
  }

  double power() {
    const double base = factor();
    return take("^") ? std::pow(base, factor()) : base;
  }

  double factor() {
    if (++nesting_ > kNestingMax) throw ProgramFault{text_, "is nested too deep"};
    const double result = signed_factor();
    --nesting_;
    return result;
  }

  double signed_factor() {
    if (take("-")) return -factor();
    if (take("+")) return factor();
    if (take("(")) {
      const double inner = sum();
      if (!take(")")) throw ProgramFault{text_, "lacks ')'"};
      return inner;
    }
    if (take("PI")) return std::numbers::pi;
    for (const auto& [name, function] : kFunctions)
      if (take(name)) return function(factor());
    const std::size_t from = at_;
    while (at_ < text_.size() && (text_[at_] == 'Q' || text_[at_] == 'L' || text_[at_] == 'R') &&
           (at_ == from ? text_[at_] == 'Q' : at_ == from + 1))
      ++at_;
    while (at_ < text_.size() && (is_digit(text_[at_]) || text_[at_] == '.')) ++at_;
    return values_.of(text_.substr(from, at_ - from));
  }

  std::string text_;
  const KlartextValues& values_;
  std::size_t at_ = 0;
  int nesting_ = 0;
};

}  // namespace

double KlartextValues::of(const std::string& word) const {
  std::string_view rest = word;
  const double sign = rest.starts_with('-') ? -1 : 1;
  if (rest.starts_with('-') || rest.starts_with('+')) rest.remove_prefix(1);
  if (rest.starts_with('Q')) {
    const auto it = values_.find(std::string(rest));
    if (it == values_.end()) throw ProgramFault{std::string(rest), "has no value yet"};
    return sign * it->second;
  }
  double value = 0;
  const auto read = number_of_chars(rest.data(), rest.data() + rest.size(), value);
  const bool whole = read.ptr == rest.data() + rest.size() ||
                     (read.ptr + 1 == rest.data() + rest.size() && *read.ptr == '.');
  if (rest.empty() || read.ec != std::errc{} || !whole || !std::isfinite(value))
    throw ProgramFault{word, rest.empty() ? "a number is missing" : "is not a number"};
  return sign * value;
}

double KlartextValues::formula(std::string_view text) const { return Formula(text, *this).value(); }

bool KlartextValues::assign(std::string_view text) {
  const std::size_t sign = text.find('=');
  if (!text.starts_with('Q') || sign == std::string_view::npos) return false;
  std::string name(text.substr(0, sign));
  std::erase(name, ' ');
  if (name.size() < 2 || !is_digit(name.back()) || name.size() > 8)
    throw ProgramFault{name, "is not a numbered parameter (Q1, QL1, QR1), which is needed here"};
  if (values_.size() >= kParametersMax) throw ProgramFault{name, "is one parameter too many"};
  values_[name] = formula(text.substr(sign + 1));
  return true;
}

}  // namespace kerf
