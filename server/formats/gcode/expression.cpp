// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/expression.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <span>

#include "server/formats/control/fault.h"
#include "server/formats/letter_case.h"
#include "server/formats/number_text.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

bool equal(double a, double b) { return std::abs(a - b) < kGcodeEqualTolerance; }

struct BinaryOperator {
  std::string_view word;
  int precedence;  ///< higher binds tighter; equal ones associate from left to right
  double (*apply)(double, double);
};

double modulo(double a, double b) {
  const double rest = std::fmod(a, b);
  return rest < 0 ? rest + std::abs(b) : rest;
}

// The first match counts, so "**" precedes "*".
constexpr std::array kOperators{
    BinaryOperator{"**", 5, [](double a, double b) { return std::pow(a, b); }},
    BinaryOperator{"*", 4, [](double a, double b) { return a * b; }},
    BinaryOperator{"/", 4, [](double a, double b) { return a / b; }},
    BinaryOperator{"mod", 4, modulo},
    BinaryOperator{"+", 3, [](double a, double b) { return a + b; }},
    BinaryOperator{"-", 3, [](double a, double b) { return a - b; }},
    BinaryOperator{"eq", 2, [](double a, double b) { return equal(a, b) ? 1.0 : 0.0; }},
    BinaryOperator{"ne", 2, [](double a, double b) { return equal(a, b) ? 0.0 : 1.0; }},
    BinaryOperator{"gt", 2, [](double a, double b) { return a > b ? 1.0 : 0.0; }},
    BinaryOperator{"ge", 2, [](double a, double b) { return a >= b ? 1.0 : 0.0; }},
    BinaryOperator{"lt", 2, [](double a, double b) { return a < b ? 1.0 : 0.0; }},
    BinaryOperator{"le", 2, [](double a, double b) { return a <= b ? 1.0 : 0.0; }},
    BinaryOperator{"and", 1, [](double a, double b) { return a != 0 && b != 0 ? 1.0 : 0.0; }},
    BinaryOperator{"xor", 1, [](double a, double b) { return (a != 0) != (b != 0) ? 1.0 : 0.0; }},
    BinaryOperator{"or", 1, [](double a, double b) { return a != 0 || b != 0 ? 1.0 : 0.0; }},
};

bool below(double a, double b) { return a < b - kMacroEqualTolerance; }
bool same(double a, double b) { return std::abs(a - b) <= kMacroEqualTolerance; }
double bits(double a, double b, std::int64_t (*apply)(std::int64_t, std::int64_t)) {
  if (std::abs(a) > 1e15 || std::abs(b) > 1e15) return std::nan("");
  return static_cast<double>(apply(std::llround(a), std::llround(b)));
}

// Macro B: AND binds as *, OR and XOR bind as +, and work on bits. "Vacant" operands (NaN) are
// handled by operation().
constexpr std::array kMacroOperators{
    BinaryOperator{"*", 4, [](double a, double b) { return a * b; }},
    BinaryOperator{"/", 4, [](double a, double b) { return a / b; }},
    BinaryOperator{"mod", 4, [](double a, double b) { return std::fmod(a, b); }},
    BinaryOperator{"and", 4,
                   [](double a, double b) {
                     return bits(a, b, [](std::int64_t x, std::int64_t y) { return x & y; });
                   }},
    BinaryOperator{"+", 3, [](double a, double b) { return a + b; }},
    BinaryOperator{"-", 3, [](double a, double b) { return a - b; }},
    BinaryOperator{"or", 3,
                   [](double a, double b) {
                     return bits(a, b, [](std::int64_t x, std::int64_t y) { return x | y; });
                   }},
    BinaryOperator{"xor", 3,
                   [](double a, double b) {
                     return bits(a, b, [](std::int64_t x, std::int64_t y) { return x ^ y; });
                   }},
    BinaryOperator{"eq", 2, [](double a, double b) { return same(a, b) ? 1.0 : 0.0; }},
    BinaryOperator{"ne", 2, [](double a, double b) { return same(a, b) ? 0.0 : 1.0; }},
    BinaryOperator{"gt", 2, [](double a, double b) { return below(b, a) ? 1.0 : 0.0; }},
    BinaryOperator{"ge", 2, [](double a, double b) { return below(a, b) ? 0.0 : 1.0; }},
    BinaryOperator{"lt", 2, [](double a, double b) { return below(a, b) ? 1.0 : 0.0; }},
    BinaryOperator{"le", 2, [](double a, double b) { return below(b, a) ? 0.0 : 1.0; }},
};

// Comparisons distinguish a vacant operand. Other operators take it as 0.
double apply_macro(const BinaryOperator& op, double a, double b) {
  const bool vacant = std::isnan(a) != std::isnan(b);
  if (op.word == "eq" && vacant) return 0;
  if (op.word == "ne" && vacant) return 1;
  return op.apply(std::isnan(a) ? 0 : a, std::isnan(b) ? 0 : b);
}

struct Function {
  std::string_view word;
  double (*apply)(double);
};

// The first match counts, so no word may precede a longer one that begins with it. A value outside
// of the function's domain gives NaN, which the caller rejects.
constexpr std::array kFunctions{
    Function{"abs", [](double x) { return std::abs(x); }},
    Function{"acos", [](double x) { return std::acos(x) / kRadPerDeg; }},
    Function{"asin", [](double x) { return std::asin(x) / kRadPerDeg; }},
    Function{"cos", [](double x) { return std::cos(x * kRadPerDeg); }},
    Function{"exp", [](double x) { return std::exp(x); }},
    Function{"fix", [](double x) { return std::floor(x); }},
    Function{"fup", [](double x) { return std::ceil(x); }},
    Function{"ln", [](double x) { return x > 0 ? std::log(x) : std::nan(""); }},
    Function{"round", [](double x) { return std::round(x); }},
    Function{"sin", [](double x) { return std::sin(x * kRadPerDeg); }},
    Function{"sqrt", [](double x) { return std::sqrt(x); }},
    Function{"tan", [](double x) { return std::tan(x * kRadPerDeg); }},
};

// Functions of Macro B that differ. FIX and FUP round towards and away from 0.
constexpr std::array kMacroFunctions{
    Function{"fix", [](double x) { return std::trunc(x); }},
    Function{"fup", [](double x) { return x < 0 ? std::floor(x) : std::ceil(x); }},
};

}  // namespace

bool is_gcode_integer(double value) {
  return std::abs(value) <= 1e9 && std::abs(value - std::round(value)) <= kGcodeIntegerTolerance;
}

void GcodeValueReader::reject(const std::string& reason) const {
  throw ProgramFault{to_upper(std::string(line_.substr(std::min({word_, at_, line_.size()})))),
                     reason};
}

std::string GcodeValueReader::word_since(std::size_t start) const {
  return to_upper(text_since(std::min(word_, start)));
}

bool GcodeValueReader::accept(std::string_view word) {
  if (!line_.substr(at_).starts_with(word)) return false;
  at_ += word.size();
  return true;
}

void GcodeValueReader::expect(char c) {
  if (peek() != c) reject(std::string("expected '") + c + "'");
  skip();
}

double GcodeValueReader::value() {
  const std::size_t start = at_;
  if (++depth_ > kGcodeNestingMax)
    reject("is nested deeper than " + std::to_string(kGcodeNestingMax) + " levels");
  const double result = value_within();
  --depth_;
  if (parameters_.vacant() && std::isnan(result)) return result;  // a vacant variable
  return finite(result, start);
}

double GcodeValueReader::expression() { return operation(value(), 1); }

double GcodeValueReader::finite(double result, std::size_t start) const {
  if (!std::isfinite(result)) throw ProgramFault{word_since(start), "has no finite value"};
  return result;
}

bool GcodeValueReader::at_function() const {
  const std::string_view rest = line_.substr(std::min(at_, line_.size()));
  if (rest.starts_with("atan[") || rest.starts_with("pow[")) return true;
  for (const Function& function : kFunctions)
    if (rest.starts_with(function.word) && rest.substr(function.word.size()).starts_with('['))
      return true;
  return false;
}

double GcodeValueReader::value_within() {
  const char c = peek();
  if (c == '[') return bracket();
  if (c == '#') {
    skip();
    return parameter();
  }
  if (c == '+' || c == '-') {
    skip();
    const double magnitude = value();
    return c == '-' ? -magnitude : magnitude;
  }
  if (is_digit(c) || c == '.') return number();
  if (c >= 'a' && c <= 'z') return function();
  reject(done() ? "a value is missing" : "is not a value (number, [expression], # or function)");
}

double GcodeValueReader::number() {
  const std::size_t start = at_;
  bool digits = false;
  bool point = false;
  while (is_digit(peek()) || (peek() == '.' && !point)) {
    (peek() == '.' ? point : digits) = true;
    skip();
  }
  if (!digits) throw ProgramFault{word_since(start), "is not a number"};
  const std::string_view text = line_.substr(start, at_ - start);
  double result = 0;
  const auto read =
      number_of_chars(text.data(), text.data() + text.size(), result, std::chars_format::fixed);
  if (read.ec != std::errc{}) throw ProgramFault{word_since(start), "is not a number"};
  return result;
}

double GcodeValueReader::bracket() {
  expect('[');
  const double result = operation(value(), 1);
  if (peek() != ']') reject(done() ? "a ']' is missing" : "must be an operator or ']'");
  skip();
  return result;
}

double GcodeValueReader::operation(double left, int precedence) {
  const bool macros = parameters_.macros();
  const std::span<const BinaryOperator> operators =
      macros ? std::span<const BinaryOperator>(kMacroOperators) : kOperators;
  while (true) {
    const std::size_t start = at_;
    const BinaryOperator* found = nullptr;
    for (const BinaryOperator& candidate : operators) {
      if (candidate.precedence < precedence || !accept(candidate.word)) continue;
      found = &candidate;
      break;
    }
    // Skipping operators of lower precedence cannot match a part of one: only "*" and "**" have a
    // common beginning.
    if (found == nullptr) return left;
    double right = value();
    right = operation(right, found->precedence + 1);
    left = macros ? apply_macro(*found, left, right) : found->apply(left, right);
    if (!std::isfinite(left)) throw ProgramFault{word_since(start), "has no finite result"};
  }
}

// LinuxCNC: ATAN[y]/[x]. Macro B also ATAN[y,x], and ATAN[y] of a ratio.
double GcodeValueReader::arc_tangent() {
  if (!parameters_.macros()) {
    const double y = bracket();
    expect('/');
    return std::atan2(y, bracket()) / kRadPerDeg;
  }
  expect('[');
  const double y = expression();
  double x = 1;
  if (peek() == ',') {
    skip();
    x = expression();
  }
  expect(']');
  if (line_.substr(at_).starts_with("/[")) {
    skip();
    x = bracket();
  }
  return std::atan2(y, x) / kRadPerDeg;
}

double GcodeValueReader::function() {
  const std::size_t start = at_;
  if (accept("atan")) return arc_tangent();
  if (accept("exists")) return exists();
  const auto apply = [&](const Function& candidate) {
    const double argument = bracket();
    const double result = candidate.apply(std::isnan(argument) ? 0 : argument);
    if (std::isnan(result))
      throw ProgramFault{word_since(start), "is outside of the domain of the function"};
    return result;
  };
  if (parameters_.macros())
    for (const Function& candidate : kMacroFunctions)
      if (accept(candidate.word)) return apply(candidate);
  for (const Function& candidate : kFunctions)
    if (accept(candidate.word)) return apply(candidate);
  reject("is not a known function");
}

double GcodeValueReader::exists() {
  expect('[');
  expect('#');
  const auto key = parameter_key();
  expect(']');
  if (const auto* name = std::get_if<std::string>(&key)) return parameters_.named(*name) ? 1 : 0;
  return 1;  // every numbered parameter exists
}

std::variant<int, std::string> GcodeValueReader::parameter_key() {
  const std::size_t start = at_;
  if (peek() != '<') {
    const int key = integer("a parameter number");
    if (key < (parameters_.vacant() ? 0 : 1) || key > parameters_.max())
      throw ProgramFault{"#" + text_since(start), "must be a parameter number from 1 to " +
                                                      std::to_string(parameters_.max())};
    return key;
  }
  skip();
  return name();
}

std::string GcodeValueReader::name() {
  const std::size_t first = at_;
  while (!done() && peek() != '>') skip();
  std::string text = text_since(first);
  if (done()) throw ProgramFault{"<" + text, "is not closed with '>'"};
  skip();
  if (text.empty()) throw ProgramFault{"<>", "requires a name"};
  return text;
}

double GcodeValueReader::parameter() {
  const auto key = parameter_key();
  if (const int* number = std::get_if<int>(&key)) {
    using namespace gcode_parameter;
    if (!position_readable_ && *number >= kPosition && *number <= kPositionLast)
      throw ProgramFault{
          "#" + std::to_string(*number),
          "the position cannot be read while cutter compensation is on; read it before G41 or G42"};
    if (parameters_.vacant() && is_tool_life_count(*number)) {
      parameters_.note_tool_life();
      return 0;
    }
    if (parameters_.macros() && !is_macro_variable(*number, false))
      throw ProgramFault{"#" + std::to_string(*number),
                         "is a system variable of the control whose value is not known here"};
    return parameters_.numbered(*number);
  }
  const std::string& name = std::get<std::string>(key);
  const auto value = parameters_.named(name);
  if (value) return *value;
  const bool foreign = name.starts_with("_ini[") || name.starts_with("_hal[");
  throw ProgramFault{"#<" + name + ">",
                     foreign ? "is a value of the machine's configuration, which is not supported"
                             : "is not assigned"};
}

int GcodeValueReader::integer(const char* meaning) {
  const std::size_t start = at_;
  const double number = value();
  if (!is_gcode_integer(number))
    throw ProgramFault{word_since(start), std::string("must be an integer (") + meaning + ")"};
  return static_cast<int>(std::lround(number));
}

}  // namespace kerf
