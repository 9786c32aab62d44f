// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/expression.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "server/formats/control/fault.h"
#include "server/formats/control/formula_functions.h"
#include "server/formats/letter_case.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

bool equal(double a, double b) { return std::abs(a - b) < kGcodeEqualTolerance; }

double modulo(double a, double b) {
  const double rest = std::fmod(a, b);
  return rest < 0 ? rest + std::abs(b) : rest;
}

constexpr FormulaOperator kOperators[] = {
    {"**", 5, [](double a, double b) { return std::pow(a, b); }},
    {"*", 4, formula::times},
    {"/", 4, formula::over},
    {"mod", 4, modulo},
    {"+", 3, formula::plus},
    {"-", 3, formula::minus},
    {"eq", 2, [](double a, double b) { return equal(a, b) ? 1.0 : 0.0; }},
    {"ne", 2, [](double a, double b) { return equal(a, b) ? 0.0 : 1.0; }},
    {"gt", 2, [](double a, double b) { return a > b ? 1.0 : 0.0; }},
    {"ge", 2, [](double a, double b) { return a >= b ? 1.0 : 0.0; }},
    {"lt", 2, [](double a, double b) { return a < b ? 1.0 : 0.0; }},
    {"le", 2, [](double a, double b) { return a <= b ? 1.0 : 0.0; }},
    {"and", 1, [](double a, double b) { return a != 0 && b != 0 ? 1.0 : 0.0; }},
    {"xor", 1, [](double a, double b) { return (a != 0) != (b != 0) ? 1.0 : 0.0; }},
    {"or", 1, [](double a, double b) { return a != 0 || b != 0 ? 1.0 : 0.0; }},
};

bool below(double a, double b) { return a < b - kMacroEqualTolerance; }
bool same(double a, double b) { return std::abs(a - b) <= kMacroEqualTolerance; }
template <typename Operation>
double bits(double a, double b) {
  if (std::abs(a) > 1e15 || std::abs(b) > 1e15) return std::nan("");
  return static_cast<double>(Operation()(std::llround(a), std::llround(b)));
}

// Macro B: AND binds as *, OR and XOR bind as +, and work on bits. "Vacant" operands (NaN) are
// handled by apply_macro().
constexpr FormulaOperator kMacroOperators[] = {
    {"*", 4, formula::times},
    {"/", 4, formula::over},
    {"mod", 4, [](double a, double b) { return std::fmod(a, b); }},
    {"and", 4, bits<std::bit_and<>>},
    {"+", 3, formula::plus},
    {"-", 3, formula::minus},
    {"or", 3, bits<std::bit_or<>>},
    {"xor", 3, bits<std::bit_xor<>>},
    {"eq", 2, [](double a, double b) { return same(a, b) ? 1.0 : 0.0; }},
    {"ne", 2, [](double a, double b) { return same(a, b) ? 0.0 : 1.0; }},
    {"gt", 2, [](double a, double b) { return below(b, a) ? 1.0 : 0.0; }},
    {"ge", 2, [](double a, double b) { return below(a, b) ? 0.0 : 1.0; }},
    {"lt", 2, [](double a, double b) { return below(a, b) ? 1.0 : 0.0; }},
    {"le", 2, [](double a, double b) { return below(b, a) ? 0.0 : 1.0; }},
};

// Comparisons distinguish a vacant operand. Other operators take it as 0.
double apply_macro(const FormulaOperator& op, double a, double b) {
  const bool vacant = std::isnan(a) != std::isnan(b);
  if (op.word == "eq" && vacant) return 0;
  if (op.word == "ne" && vacant) return 1;
  return op.apply(std::isnan(a) ? 0 : a, std::isnan(b) ? 0 : b);
}

constexpr std::array<FormulaFunction, 12> functions(double (*fix)(double), double (*fup)(double)) {
  return {{{"abs", formula::magnitude},
           {"acos", [](double x) { return std::acos(x) / kRadPerDeg; }},
           {"asin", [](double x) { return std::asin(x) / kRadPerDeg; }},
           {"cos", formula::cosine},
           {"exp", formula::exponential},
           {"fix", fix},
           {"fup", fup},
           {"ln", [](double x) { return x > 0 ? std::log(x) : std::nan(""); }},
           {"round", [](double x) { return std::round(x); }},
           {"sin", formula::sine},
           {"sqrt", formula::square_root},
           {"tan", formula::tangent}}};
}

constexpr auto kFunctions =
    functions([](double x) { return std::floor(x); }, [](double x) { return std::ceil(x); });
// Macro B rounds towards and away from 0.
constexpr auto kMacroFunctions =
    functions(formula::truncated, [](double x) { return x < 0 ? std::floor(x) : std::ceil(x); });

constexpr FormulaRules kLinuxcncFormulas{kOperators, kFunctions, '[', ']'};
constexpr FormulaRules kMacroFormulas{kMacroOperators, kMacroFunctions, '[', ']'};

}  // namespace

GcodeValueReader::GcodeValueReader(std::string_view line, const GcodeParameters& parameters,
                                   bool position_readable)
    : FormulaReader(line, parameters.macros() ? kMacroFormulas : kLinuxcncFormulas),
      parameters_(parameters),
      position_readable_(position_readable) {}

bool is_gcode_integer(double value) {
  return std::abs(value) <= 1e9 && std::abs(value - std::round(value)) <= kGcodeIntegerTolerance;
}

std::string GcodeValueReader::word_here() const {
  return to_upper(std::string(text().substr(std::min({word_, position(), text().size()}))));
}

std::string GcodeValueReader::word_since(std::size_t start) const {
  return to_upper(text_since(std::min(word_, start)));
}

double GcodeValueReader::checked(double value, std::size_t start) const {
  const bool vacant = parameters_.vacant() && std::isnan(value);
  if (!vacant && !std::isfinite(value))
    throw ProgramFault{word_since(start), "has no finite value"};
  return value;
}

double GcodeValueReader::apply(const FormulaOperator& op, double left, double right,
                               std::size_t start) const {
  const double result = parameters_.macros() ? apply_macro(op, left, right) : op.apply(left, right);
  if (!std::isfinite(result)) throw ProgramFault{word_since(start), "has no finite result"};
  return result;
}

bool GcodeValueReader::at_function() const {
  if (rest().starts_with("atan[") || rest().starts_with("pow[")) return true;
  return std::ranges::any_of(rules().functions, [this](const FormulaFunction& function) {
    return rest().starts_with(function.word) &&
           rest().substr(function.word.size()).starts_with('[');
  });
}

double GcodeValueReader::operand() {
  if (accept("#")) return parameter();
  return peek() >= 'a' && peek() <= 'z' ? function() : FormulaReader::operand();
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
  double x = accept(",") ? expression() : 1;
  expect(']');
  if (rest().starts_with("/[")) {
    skip();
    x = bracket();
  }
  return std::atan2(y, x) / kRadPerDeg;
}

double GcodeValueReader::function() {
  const std::size_t start = position();
  if (accept("atan")) return arc_tangent();
  if (accept("exists")) return exists();
  const FormulaFunction* known = accept_function();
  if (known == nullptr) reject("is not a known function");
  const double argument = bracket();
  const double result = known->of_one(std::isnan(argument) ? 0 : argument);
  if (std::isnan(result))
    throw ProgramFault{word_since(start), "is outside of the domain of the function"};
  return result;
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
  const std::size_t start = position();
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
  const std::size_t first = position();
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
  const std::size_t start = position();
  const double number = value();
  if (!is_gcode_integer(number))
    throw ProgramFault{word_since(start), std::string("must be an integer (") + meaning + ")"};
  return static_cast<int>(std::lround(number));
}

}  // namespace kerf
