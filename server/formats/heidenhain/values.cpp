// SPDX-License-Identifier: Apache-2.0
#include "server/formats/heidenhain/values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "server/formats/control/fault.h"
#include "server/formats/control/formula.h"
#include "server/formats/control/formula_functions.h"
#include "server/formats/letter_case.h"
#include "server/formats/number_text.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr std::size_t kParametersMax = 10'000;

constexpr FormulaOperator kOperators[] = {
    {"+", 1, formula::plus},
    {"-", 1, formula::minus},
    {"*", 2, formula::times},
    {"/", 2, formula::over},
    {"DIV", 2, formula::over},
    {"LEN", 2, [](double a, double b) { return std::hypot(a, b); }},
    {"^", 3, [](double a, double b) { return std::pow(a, b); }, false},
};

constexpr FormulaFunction kFunctions[] = {
    {"ASIN", formula::arc_sine},
    {"ACOS", formula::arc_cosine},
    {"ATAN", [](double v) { return kDegPerRad * std::atan(v); }},
    {"SIN", formula::sine},
    {"COS", formula::cosine},
    {"TAN", formula::tangent},
    {"SQRT", formula::square_root},
    {"ABS", formula::magnitude},
    {"INT", formula::truncated},
    {"FRAC", [](double v) { return v - std::trunc(v); }},
    {"NEG", [](double v) { return -v; }},
    {"LOG", [](double v) { return std::log10(v); }},
    {"LN", formula::logarithm},
    {"EXP", formula::exponential},
    {"SGN", [](double v) { return v > 0   ? 1.0
                                  : v < 0 ? -1.0
                                          : 0.0; }},
};

constexpr FormulaRules kKlartextFormulas{kOperators, kFunctions, '(', ')'};

/// A formula without blanks, with decimal points. A function binds closer than a power and needs no
/// parentheses.
class KlartextFormula final : public FormulaReader {
 public:
  KlartextFormula(std::string_view text, const KlartextValues& values)
      : FormulaReader(text, kKlartextFormulas), values_(values) {}

  double whole() {
    const double result = expression();
    if (!done()) reject("is not part of a formula");
    if (!std::isfinite(result)) throw ProgramFault{std::string(text()), "has no finite value"};
    return result;
  }

 private:
  double operand() override {
    if (accept("PI")) return std::numbers::pi;
    if (const FormulaFunction* known = accept_function()) return known->of_one(value());
    if (peek() != 'Q') return FormulaReader::operand();
    const std::size_t start = position();
    skip();
    if (peek() == 'L' || peek() == 'R') skip();
    while (is_digit(peek())) skip();
    return values_.of(word_since(start));
  }

  const KlartextValues& values_;
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

double KlartextValues::formula(std::string_view text) const {
  std::string plain(text);
  std::erase(plain, ' ');
  std::ranges::replace(plain, ',', '.');
  return KlartextFormula(plain, *this).whole();
}

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
