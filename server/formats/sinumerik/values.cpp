// SPDX-License-Identifier: Apache-2.0
#include "server/formats/sinumerik/values.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "server/formats/control/fault.h"
#include "server/formats/control/formula.h"
#include "server/formats/control/formula_functions.h"
#include "server/formats/letter_case.h"
#include "server/formats/number_text.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

/// Greatest number of an R parameter.
constexpr double kParameterMax = 99'999;
constexpr double kEqual = 1e-9;

bool begins_name(char c) { return (c >= 'A' && c <= 'Z') || c == '_' || c == '$'; }
bool nearly_equal(double a, double b) {
  return std::abs(a - b) <= kEqual * std::max(1.0, std::abs(a));
}

// Comparisons bind weakest.
constexpr FormulaOperator kOperators[] = {
    {"==", 1, [](double a, double b) { return nearly_equal(a, b) ? 1.0 : 0.0; }},
    {"<>", 1, [](double a, double b) { return nearly_equal(a, b) ? 0.0 : 1.0; }},
    {"<=", 1, [](double a, double b) { return a < b || nearly_equal(a, b) ? 1.0 : 0.0; }},
    {">=", 1, [](double a, double b) { return a > b || nearly_equal(a, b) ? 1.0 : 0.0; }},
    {"<", 1, [](double a, double b) { return a < b && !nearly_equal(a, b) ? 1.0 : 0.0; }},
    {">", 1, [](double a, double b) { return a > b && !nearly_equal(a, b) ? 1.0 : 0.0; }},
    {"OR", 2, [](double a, double b) { return a != 0 || b != 0 ? 1.0 : 0.0; }},
    {"XOR", 2, [](double a, double b) { return (a != 0) != (b != 0) ? 1.0 : 0.0; }},
    {"AND", 3, [](double a, double b) { return a != 0 && b != 0 ? 1.0 : 0.0; }},
    {"+", 4, formula::plus},
    {"-", 4, formula::minus},
    {"*", 5, formula::times},
    {"/", 5, formula::over},
    {"DIV", 5, [](double a, double b) { return std::trunc(a / b); }},
    {"MOD", 5, [](double a, double b) { return std::fmod(a, b); }},
};

constexpr FormulaFunction kFunctions[] = {
    {"SIN", formula::sine},
    {"COS", formula::cosine},
    {"TAN", formula::tangent},
    {"ASIN", formula::arc_sine},
    {"ACOS", formula::arc_cosine},
    {"ATAN2", nullptr, [](double y, double x) { return kDegPerRad * std::atan2(y, x); }},
    {"SQRT", formula::square_root},
    {"POT", [](double v) { return v * v; }},
    {"ABS", formula::magnitude},
    {"TRUNC", formula::truncated},
    {"ROUND", [](double v) { return std::floor(v + 0.5); }},
    {"LN", formula::logarithm},
    {"EXP", formula::exponential},
    {"MINVAL", nullptr, [](double a, double b) { return std::min(a, b); }},
    {"MAXVAL", nullptr, [](double a, double b) { return std::max(a, b); }},
};

constexpr FormulaRules kSinumerikFormulas{kOperators, kFunctions, '(', ')', is_sinumerik_name};

class SinumerikFormula final : public FormulaReader {
 public:
  SinumerikFormula(std::string_view text, std::size_t at, const SinumerikValues& values)
      : FormulaReader(text, kSinumerikFormulas, at), values_(values) {}

 private:
  double operand() override {
    if (accept("NOT")) return value() == 0;
    if (begins_name(peek())) return named();
    const double number = FormulaReader::operand();
    if (!rest().starts_with("EX")) return number;
    skip();
    skip();
    return number * std::pow(10.0, value());
  }

  double checked(double value, std::size_t) const override {
    if (!std::isfinite(value)) throw ProgramFault{std::string(text()), "has no finite value"};
    return value;
  }

  double apply(const FormulaOperator& op, double left, double right, std::size_t) const override {
    const bool divides = op.word == "/" || op.word == "DIV" || op.word == "MOD";
    if (divides && right == 0) throw ProgramFault{std::string(text()), "divides by 0"};
    return op.apply(left, right);
  }

  double named() {
    const std::size_t start = position();
    while (is_sinumerik_name(peek())) skip();
    std::string name = word_since(start);
    if (name == "TRUE") return 1;
    if (name == "FALSE") return 0;
    if (name == "$PI") return std::numbers::pi;
    if (name == "R" && accept("[")) name += index();
    return peek() == '(' ? function(name) : values_.value_of(name);
  }

  std::string index() {
    const double number = expression();
    expect(']');
    if (!(number >= 0 && number <= kParameterMax && number == std::floor(number)))
      throw ProgramFault{"R[" + decimal_text(number, 6) + "]", "is not a number of a parameter"};
    return decimal_text(number, 0);
  }

  double function(const std::string& name) {
    std::vector<double> x;
    expect('(');
    do x.push_back(expression());
    while (accept(","));
    expect(')');
    const auto known = std::ranges::find(kFunctions, name, &FormulaFunction::word);
    if (known != std::end(kFunctions)) {
      if (x.size() == 1 && known->of_one != nullptr) return known->of_one(x[0]);
      if (x.size() == 2 && known->of_two != nullptr) return known->of_two(x[0], x[1]);
    }
    throw ProgramFault{name, "is not a supported function of " + std::to_string(x.size()) +
                                 (x.size() == 1 ? " value" : " values")};
  }

  const SinumerikValues& values_;
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

double SinumerikValues::value_of(const std::string& name) const {
  const auto it = values_.find(name);
  if (it != values_.end()) return it->second;
  if (has(name)) return 0;
  throw ProgramFault{name, name.starts_with('$')
                               ? "is a system variable, whose value is not known here"
                               : "is not a variable of the program"};
}

double SinumerikValues::expression(std::string_view text, std::size_t& at) const {
  SinumerikFormula formula(text, at, *this);
  const double value = formula.expression();
  at = formula.position();
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
