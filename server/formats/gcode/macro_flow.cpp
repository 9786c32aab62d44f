// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/macro_flow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/expression.h"
#include "server/formats/letter_case.h"

namespace kerf {
namespace {

// Fanuc: P above 9999 without such a program is the number of calls and the program (P32000).
constexpr int kProgramsOfFour = 10'000;
constexpr int kCallRepeatsMax = 1'000'000;

int integer(double value, const std::string& text, int least, int most) {
  if (!is_gcode_integer(value) || value < least - 0.5 || value > most + 0.5)
    throw ProgramFault{
        text, "must be an integer from " + std::to_string(least) + " to " + std::to_string(most)};
  return static_cast<int>(std::lround(value));
}

// The variable of an argument of G65: A is #1, …, Z is #26.
int argument_variable(char letter) {
  constexpr std::string_view kLetters = "abcijkdef h m   qrstuvwxyz";
  const auto at = kLetters.find(letter);
  return at == std::string_view::npos || letter == ' ' ? 0 : static_cast<int>(at) + 1;
}

// I, J and K may be repeated: I1 is #4, J1 #5, K1 #6, I2 #7, … K10 #33.
class IjkArguments {
 public:
  int variable_of(char letter, const std::string& text) {
    const std::size_t place = static_cast<std::size_t>(letter - 'i');
    if (given_[place]) {
      ++group_;
      given_ = {};
    }
    for (std::size_t later = place + 1; later < given_.size(); ++later)
      if (given_[later])
        throw ProgramFault{text, "is out of order: arguments I, J and K must have this order"};
    given_[place] = true;
    const int variable = 4 + 3 * group_ + static_cast<int>(place);
    if (variable > kMacroLocalParameters) throw ProgramFault{text, "is one argument too many"};
    return variable;
  }

 private:
  int group_ = 0;
  std::array<bool, 3> given_{};  ///< in this group
};

}  // namespace

MacroFlow::MacroFlow(GcodeSource& source, GcodeParameters& parameters, const DialectRules& rules,
                     std::size_t lines_max, Listener listener)
    : ProgramFlow(source, parameters, lines_max), rules_(rules), listener_(std::move(listener)) {}

std::optional<GcodeLine> MacroFlow::next() {
  for (std::size_t passed = 0; !ended_; ++passed) {
    if (passed == kGcodeLinesPerStep) return GcodeLine{};
    const auto read = read_line();
    if (!read) {
      if (frames_.empty()) return std::nullopt;
      throw ProgramFault{"", "the file ends within a subprogram; M99 is missing"};
    }
    const std::string_view text = *read;
    const auto first = text.find_first_not_of(" \t\r");
    if (first != std::string_view::npos && text[first] == '%') {
      if (is_percent(text)) {
        ended_ = started_ && frames_.empty();
      } else if (started_) {
        listener_.warn("text after % is not for the control, and is left out");
      }
      continue;
    }
    GcodeLine line = split_gcode_line(text, rules_);
    std::string_view code = line.code;
    if (leading_number(code, "o:", code)) {
      // The next program of the file begins: the main program has ended.
      if (frames_.empty() && std::exchange(header_seen_, true)) return ended_ = true, std::nullopt;
      if (!frames_.empty()) throw ProgramFault{"", "the subprogram ends without M99"};
      started_ = true;
      continue;  // the program's name follows the number
    }
    leading_number(code, "n", code);
    if (code.empty() && line.comment.empty()) continue;
    if (code.empty()) return GcodeLine{.code = {}, .comment = std::move(line.comment)};
    if (code.starts_with('$')) {
      listener_.warn(to_upper(std::string(code)) +
                     " is a command to the control's program, which "
                     "is left out");
      continue;
    }
    started_ = true;
    if (code.starts_with('/')) {
      if (!std::exchange(skips_said_, true))
        listener_.warn("lines that begin with / are skipped: block delete is on");
      continue;
    }
    auto rest = control(std::string(code));
    if (!rest || rest->empty()) continue;
    line.code = *std::move(rest);
    return line;
  }
  return std::nullopt;
}

std::optional<std::string> MacroFlow::control(const std::string& code) {
  const auto begins = [&code](std::string_view word) { return code.starts_with(word); };
  if (begins("if[")) return branch(code);
  if (begins("while[") || begins("wh[") || begins("do") || begins("end"))
    return loop(code), std::nullopt;
  if (begins("goto")) {
    GcodeValueReader reader(code, parameters_, listener_.position_readable());
    reader.accept("goto");
    jump(reader.integer("a sequence number"), to_upper(code));
    return std::nullopt;
  }
  for (const std::string_view output : {"dprnt", "bprnt", "popen", "pclos", "setvn"})
    if (begins(output)) return std::nullopt;
  return code;
}

// IF[condition]GOTO n, IF[condition]THEN statement, IF[condition] statement.
std::optional<std::string> MacroFlow::branch(const std::string& code) {
  GcodeValueReader reader(code, parameters_, listener_.position_readable());
  reader.accept("if");
  const bool holds = reader.bracket() == 1;
  if (!holds) return std::nullopt;
  if (reader.accept("goto")) {
    jump(reader.integer("a sequence number"), to_upper(code));
    return std::nullopt;
  }
  reader.accept("then");
  if (reader.done()) throw ProgramFault{to_upper(code), "requires GOTO or a statement on its line"};
  return code.substr(reader.position());
}

void MacroFlow::loop(const std::string& code) {
  GcodeValueReader reader(code, parameters_, listener_.position_readable());
  const std::string text = to_upper(code);
  const std::size_t here = at_.line - 1;
  if (reader.accept("end")) {
    const int number = integer(reader.value(), text, 1, 9);
    const auto start = source_.file(at_.file).marks().start_of(number, here);
    if (!start) throw ProgramFault{text, "has no matching DO"};
    at_.line = *start;
    return;
  }
  bool holds = true;
  if (reader.accept("while") || reader.accept("wh")) holds = reader.bracket() == 1;
  if (!reader.accept("do")) throw ProgramFault{text, "requires DO with a number"};
  const int number = integer(reader.value(), text, 1, 9);
  const auto end = source_.file(at_.file).marks().end_of(number, here);
  if (!end) throw ProgramFault{text, "has no matching END"};
  if (!holds) at_.line = *end + 1;
}

void MacroFlow::jump(int sequence, const std::string& text) {
  const auto line = source_.file(at_.file).marks().sequence(sequence, at_.line - 1);
  if (!line)
    throw ProgramFault{text, "jumps to N" + std::to_string(sequence) +
                                 ", which the program "
                                 "does not have"};
  at_.line = *line;
}

void MacroFlow::moved() {
  ProgramFlow::moved();
  if (modal_ && frames_.size() == modal_depth_) {
    Call call = *modal_;
    call.kind = Call::Kind::kMacro;
    execute(call);
  }
}

std::optional<MacroFlow::Call> MacroFlow::take_call(GcodeBlock& block) {
  const GcodeCode* code = block.code(GcodeGroup::kJump);
  if (code == nullptr) return std::nullopt;
  Call call{.kind = code->code == 97   ? Call::Kind::kLocal
                    : code->code == 98 ? Call::Kind::kSubprogram
                                       : Call::Kind::kReturn,
            .arguments = {},
            .text = code->text};
  const auto take = [&](char letter, int least, int most) -> std::optional<int> {
    const auto value = block.take(letter);
    if (!value) return std::nullopt;
    const std::string text = block.find(letter)->text;
    std::erase_if(block.words, [letter](const GcodeWord& w) { return w.letter == letter; });
    return integer(*value, text, least, most);
  };
  const auto number = take('p', 1, 999'999'999);
  if (!number && call.kind != Call::Kind::kReturn)
    throw ProgramFault{call.text, "requires P, the number of the program to call"};
  call.number = number.value_or(0);
  call.repeats = take('l', 0, kCallRepeatsMax).value_or(1);
  return call;
}

std::optional<MacroFlow::Call> MacroFlow::read_macro_call(std::string_view code) const {
  const bool modal = code.starts_with("g66");
  if (!modal && !code.starts_with("g65")) return std::nullopt;
  if (code.size() > 3 && (code[3] == '.' || (code[3] >= '0' && code[3] <= '9')))
    return std::nullopt;
  Call call{.kind = modal ? Call::Kind::kModal : Call::Kind::kMacro,
            .arguments = std::vector<double>(kMacroLocalParameters, std::nan("")),
            .text = to_upper(std::string(code.substr(0, 3)))};
  GcodeValueReader reader(code, parameters_, listener_.position_readable());
  reader.accept(code.substr(0, 3));
  IjkArguments ijk;
  while (!reader.done()) {
    const std::size_t start = reader.position();
    reader.begin_word();
    const char letter = reader.peek();
    reader.skip();
    const double value = reader.value();
    const std::string text = to_upper(reader.text_since(start));
    if (letter == 'p') {
      call.number = integer(value, text, 1, 999'999);
    } else if (letter == 'l') {
      call.repeats = integer(value, text, 0, kCallRepeatsMax);
    } else if (const int variable = argument_variable(letter)) {
      const bool grouped = letter >= 'i' && letter <= 'k';
      const int at = grouped ? ijk.variable_of(letter, text) : variable;
      call.arguments[static_cast<std::size_t>(at - 1)] = value;
    } else {
      throw ProgramFault{text, "is not an argument of a macro call"};
    }
  }
  if (call.number == 0) throw ProgramFault{call.text, "requires P, the number of the macro"};
  if (!parameters_.vacant())
    for (double& argument : call.arguments)
      if (std::isnan(argument)) argument = 0;
  return call;
}

bool MacroFlow::execute(const Call& call) {
  if (call.kind == Call::Kind::kReturn) return leave(call);
  if (call.kind == Call::Kind::kModal) {
    modal_ = call;
    modal_depth_ = frames_.size();
    return false;
  }
  if (call.repeats == 0) return false;
  if (frames_.size() >= kMacroCallDepthMax)
    throw ProgramFault{call.text, "calls are nested deeper than " +
                                      std::to_string(kMacroCallDepthMax) + " levels"};
  if (call.kind == Call::Kind::kLocal || call.kind == Call::Kind::kLocalElseSubprogram) {
    const auto line = source_.file(at_.file).marks().sequence(call.number, at_.line - 1);
    if (line) return enter({at_.file, *line}, call), false;
    if (call.kind == Call::Kind::kLocal)
      throw ProgramFault{
          call.text, "calls N" + std::to_string(call.number) + ", which the program does not have"};
  }
  Call made = call;
  auto place = find_program(call.number);
  if (!place && call.kind == Call::Kind::kSubprogram && call.number >= kProgramsOfFour) {
    made.repeats = call.number / kProgramsOfFour;
    place = find_program(call.number % kProgramsOfFour);
  }
  if (!place)
    throw ProgramFault{call.text, "calls O" + std::to_string(call.number) +
                                      ", which is neither in the program nor in a file beside it"};
  enter(*place, made);
  return false;
}

void MacroFlow::enter(Place start, const Call& call) {
  const bool shares = call.kind != Call::Kind::kMacro;
  if (shares) {
    parameters_.enter_sharing();
  } else {
    parameters_.enter(call.arguments);
  }
  frames_.push_back({start, at_, shares, call.repeats - 1, call.arguments});
  at_ = start;
  listener_.entered();
}

bool MacroFlow::leave(const Call& call) {
  if (frames_.empty()) {
    if (call.number != 0) return jump(call.number, call.text), false;
    listener_.warn("M99 ends the program here; the machine would begin again");
    return true;
  }
  Frame& frame = frames_.back();
  if (frame.repeats_left > 0 && call.number == 0) {
    --frame.repeats_left;
    if (!frame.shares) {
      parameters_.leave();
      parameters_.enter(frame.arguments);
    }
    at_ = frame.start;
    return false;
  }
  parameters_.leave();
  listener_.left();
  at_ = frame.back;
  frames_.pop_back();
  if (modal_ && frames_.size() < modal_depth_) modal_.reset();
  if (call.number != 0) jump(call.number, call.text);
  return false;
}

std::optional<MacroFlow::Place> MacroFlow::find_program(int number) {
  for (const std::size_t file : {at_.file, std::size_t{0}})
    if (const auto line = source_.file(file).marks().program(number)) return Place{file, *line + 1};
  const std::string digits = std::to_string(number);
  const std::string four = std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits;
  for (const std::string& name : {"O" + four, "o" + four, four, "O" + digits, digits}) {
    const std::size_t file = source_.find(name);
    if (file == 0) continue;
    if (const auto line = source_.file(file).marks().program(number)) return Place{file, *line + 1};
    return Place{file, 0};  // a file without a program number is named after it
  }
  return std::nullopt;
}

}  // namespace kerf
