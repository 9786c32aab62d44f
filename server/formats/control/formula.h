// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace kerf {

/// Deepest nesting of brackets, signs and functions in one value. Bounds the recursion on hostile
/// lines.
inline constexpr int kFormulaNestingMax = 100;

/// A binary operator.
struct FormulaOperator {
  std::string_view word;
  int precedence;  ///< higher binds tighter; equal ones associate from left to right
  double (*apply)(double, double);
  bool repeats = true;  ///< whether it may follow its own result without brackets
};

/// A function of one or two values. A value outside of its domain gives NaN.
struct FormulaFunction {
  std::string_view word;
  double (*of_one)(double);
  double (*of_two)(double, double) = nullptr;
};

/// The formulas of a control. The first match in a table counts, so no word may precede a longer
/// one that begins with it.
struct FormulaRules {
  std::span<const FormulaOperator> operators;
  std::span<const FormulaFunction> functions;
  char opens, closes;  ///< brackets
  /// Whether a character belongs to a name, so that a word of letters must end before it; nullptr
  /// if words are written without blanks between them.
  bool (*in_name)(char) = nullptr;
};

/// A parser of the formulas in a text: numbers, signs, brackets, binary operators and functions.
/// A control adds its operands. Angles are in degrees. Throws ProgramFault.
class FormulaReader {
 public:
  /// `text` and `rules` must outlive it. Reads from `at` on.
  FormulaReader(std::string_view text, const FormulaRules& rules, std::size_t at = 0)
      : text_(text), rules_(rules), at_(at) {}
  FormulaReader(const FormulaReader&) = delete;
  FormulaReader& operator=(const FormulaReader&) = delete;
  virtual ~FormulaReader() = default;

  bool done() const { return at_ >= text_.size(); }
  /// The next character, '\0' at the end.
  char peek() const { return done() ? '\0' : text_[at_]; }
  void skip() { ++at_; }
  std::size_t position() const { return at_; }
  /// Skips `word` and returns true if it comes next, and a whole word if the rules require that.
  /// Then blanks before it are skipped too.
  bool accept(std::string_view word);

  /// Reads a value with binary operators.
  double expression();
  /// Reads a value without binary operators, which may stand within brackets only.
  double value();
  /// Reads an expression in brackets.
  double bracket();

 protected:
  /// Reads an operand without sign and brackets: here a number.
  virtual double operand();
  /// Checks or changes a value that begins at `start`.
  virtual double checked(double value, std::size_t) const { return value; }
  /// Applies an operator that begins at `start`.
  virtual double apply(const FormulaOperator& op, double left, double right, std::size_t) const {
    return op.apply(left, right);
  }
  /// The text that a fault at the current position names, and at one that begins at `start`.
  virtual std::string word_here() const { return std::string(done() ? text_ : rest()); }
  virtual std::string word_since(std::size_t start) const {
    return std::string(text_.substr(start, at_ - start));
  }
  /// Throws a fault at the current position.
  [[noreturn]] void reject(const std::string& reason) const;

  const FormulaRules& rules() const { return rules_; }
  std::string_view text() const { return text_; }
  std::string_view rest() const { return done() ? std::string_view() : text_.substr(at_); }
  void skip_blanks();
  void expect(char c);
  double number();
  /// Skips the name of a function and returns it, or nullptr.
  const FormulaFunction* accept_function();

 private:
  double value_within();
  double operation(double left, int precedence);
  const FormulaOperator* accept_operator(int precedence);

  std::string_view text_;
  const FormulaRules& rules_;
  std::size_t at_;
  int depth_ = 0;
};

}  // namespace kerf
