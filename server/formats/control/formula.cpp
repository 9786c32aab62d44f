// SPDX-License-Identifier: Apache-2.0
#include "server/formats/control/formula.h"

#include <charconv>

#include "server/formats/control/fault.h"
#include "server/formats/letter_case.h"
#include "server/formats/number_text.h"

namespace kerf {

void FormulaReader::reject(const std::string& reason) const {
  throw ProgramFault{word_here(), reason};
}

void FormulaReader::skip_blanks() {
  while (peek() == ' ') skip();
}

bool FormulaReader::accept(std::string_view word) {
  const auto in_name = rules_.in_name;
  if (in_name != nullptr) skip_blanks();
  if (!rest().starts_with(word)) return false;
  const std::size_t end = at_ + word.size();
  if (in_name != nullptr && in_name(word.back()) && end < text_.size() && in_name(text_[end]))
    return false;
  at_ = end;
  return true;
}

void FormulaReader::expect(char c) {
  if (!accept({&c, 1})) reject(std::string("lacks '") + c + "'");
}

double FormulaReader::expression() { return operation(value(), 0); }

double FormulaReader::bracket() {
  expect(rules_.opens);
  const double inner = expression();
  if (!done() && peek() != rules_.closes)
    reject(std::string("must be an operator or '") + rules_.closes + "'");
  expect(rules_.closes);
  return inner;
}

double FormulaReader::value() {
  const std::size_t start = at_;
  if (++depth_ > kFormulaNestingMax)
    reject("is nested deeper than " + std::to_string(kFormulaNestingMax) + " levels");
  const double result = value_within();
  --depth_;
  return checked(result, start);
}

double FormulaReader::value_within() {
  if (accept("-")) return -value();
  if (accept("+")) return value();
  if (peek() == rules_.opens) return bracket();
  return operand();
}

double FormulaReader::operand() {
  if (is_digit(peek()) || peek() == '.') return number();
  reject(done() ? "a value is missing" : "is not a number or an expression");
}

double FormulaReader::number() {
  const std::size_t start = at_;
  for (bool point = false; is_digit(peek()) || (peek() == '.' && !point); skip())
    point = point || peek() == '.';
  const std::string_view digits = text_.substr(start, at_ - start);
  double result = 0;
  const auto read = number_of_chars(digits.data(), digits.data() + digits.size(), result,
                                    std::chars_format::fixed);
  if (read.ec != std::errc{}) throw ProgramFault{word_since(start), "is not a number"};
  return result;
}

// An operator of lower precedence cannot match a part of another one: only words of equal
// precedence begin alike, apart from "*" and "**".
const FormulaOperator* FormulaReader::accept_operator(int precedence) {
  for (const FormulaOperator& candidate : rules_.operators)
    if (candidate.precedence >= precedence && accept(candidate.word)) return &candidate;
  return nullptr;
}

double FormulaReader::operation(double left, int precedence) {
  while (true) {
    const std::size_t start = at_;
    const FormulaOperator* found = accept_operator(precedence);
    if (found == nullptr) return left;
    const double right = operation(value(), found->precedence + 1);
    left = apply(*found, left, right, start);
    if (!found->repeats && rest().starts_with(found->word)) reject("is not part of a formula");
  }
}

const FormulaFunction* FormulaReader::accept_function() {
  for (const FormulaFunction& candidate : rules_.functions)
    if (accept(candidate.word)) return &candidate;
  return nullptr;
}

}  // namespace kerf
