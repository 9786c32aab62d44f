// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/dialect_choice.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "server/formats/letter_case.h"
#include "server/formats/text_lines.h"

namespace kerf {
namespace {

constexpr std::size_t kLinesMax = 20'000;

enum class Tongue { kLinuxcnc, kGrbl, kMach3, kFanuc, kHaas, kSiemens, kHeidenhain };
constexpr std::size_t kTongues = 7;

// A mark of a tongue outside comments. `code`: a word of a block, not followed by a digit or a
// point. Marks of Siemens and HEIDENHAIN are whole words of a line with single blanks. All other
// marks are parts of a line without blanks.
struct Mark {
  std::string_view text;
  Tongue tongue;
  int weight;
  bool code;
};

constexpr std::string_view kProgramNumber = "a program number";

constexpr std::array kMarks{
    Mark{"begin pgm", Tongue::kHeidenhain, 20, false},
    Mark{"tool call", Tongue::kHeidenhain, 10, false},
    Mark{"blk form", Tongue::kHeidenhain, 10, false},
    Mark{"cycl def", Tongue::kHeidenhain, 10, false},
    Mark{"%_n_", Tongue::kSiemens, 20, false},
    Mark{";$path=", Tongue::kSiemens, 20, false},
    Mark{"traori", Tongue::kSiemens, 10, false},
    Mark{"trafoof", Tongue::kSiemens, 10, false},
    Mark{"supa", Tongue::kSiemens, 10, false},
    Mark{"mcall", Tongue::kSiemens, 10, false},
    Mark{"gotof", Tongue::kSiemens, 10, false},
    Mark{"gotob", Tongue::kSiemens, 10, false},
    Mark{"workpiece(", Tongue::kSiemens, 10, false},
    Mark{"msg(\"", Tongue::kSiemens, 10, false},
    Mark{"cycle8", Tongue::kSiemens, 10, false},
    Mark{"cr=", Tongue::kSiemens, 6, false},
    Mark{"proc", Tongue::kSiemens, 10, false},
    Mark{"extern", Tongue::kSiemens, 10, false},
    Mark{"def real", Tongue::kSiemens, 10, false},
    Mark{"def int", Tongue::kSiemens, 10, false},
    Mark{"def bool", Tongue::kSiemens, 10, false},
    Mark{"t=\"", Tongue::kSiemens, 10, false},
    Mark{"trans", Tongue::kSiemens, 8, false},
    Mark{"atrans", Tongue::kSiemens, 8, false},
    Mark{"rot", Tongue::kSiemens, 8, false},
    Mark{"arot", Tongue::kSiemens, 8, false},
    Mark{"rpl=", Tongue::kSiemens, 8, false},
    Mark{"mirror", Tongue::kSiemens, 8, false},
    Mark{"amirror", Tongue::kSiemens, 8, false},
    Mark{"ascale", Tongue::kSiemens, 8, false},
    Mark{"rp=", Tongue::kSiemens, 8, false},
    Mark{"setal(", Tongue::kSiemens, 8, false},
    Mark{"stopre", Tongue::kSiemens, 8, false},
    Mark{"endfor", Tongue::kSiemens, 8, false},
    Mark{"g111", Tongue::kSiemens, 8, false},
    Mark{"#<", Tongue::kLinuxcnc, 20, false},
    Mark{"o<", Tongue::kLinuxcnc, 20, false},
    Mark{"m428", Tongue::kLinuxcnc, 10, true},
    Mark{"g33.1", Tongue::kLinuxcnc, 10, true},
    Mark{"g5.2", Tongue::kLinuxcnc, 10, true},
    Mark{"m70", Tongue::kLinuxcnc, 3, true},
    Mark{"g154", Tongue::kHaas, 10, true},
    Mark{"g187", Tongue::kHaas, 10, true},
    Mark{"g150", Tongue::kHaas, 6, true},
    Mark{"g12", Tongue::kHaas, 4, true},
    Mark{"g13", Tongue::kHaas, 4, true},
    Mark{"g110", Tongue::kHaas, 6, true},
    Mark{"g234", Tongue::kHaas, 8, true},
    Mark{"g254", Tongue::kHaas, 8, true},
    Mark{"g103", Tongue::kHaas, 6, true},
    Mark{"m97", Tongue::kHaas, 8, true},
    Mark{"g53g0", Tongue::kHaas, 1, false},
    Mark{"g65", Tongue::kFanuc, 8, true},
    Mark{"g66", Tongue::kFanuc, 8, true},
    Mark{"g68", Tongue::kFanuc, 6, true},
    Mark{"g51", Tongue::kFanuc, 4, true},
    Mark{"g51.1", Tongue::kFanuc, 6, true},
    Mark{"g16", Tongue::kFanuc, 6, true},
    Mark{"g15", Tongue::kFanuc, 4, true},
    Mark{"g54.1", Tongue::kFanuc, 8, true},
    Mark{"g43.5", Tongue::kFanuc, 6, true},
    Mark{"g10.9", Tongue::kFanuc, 6, true},
    Mark{"]goto", Tongue::kFanuc, 10, false},
    Mark{"]then", Tongue::kFanuc, 10, false},
    Mark{"]do", Tongue::kFanuc, 10, false},
    Mark{",r", Tongue::kFanuc, 5, true},
    Mark{",c", Tongue::kFanuc, 5, true},
};

// Marks of Fanuc and Haas that Mach3 shares. They count for Mach3 if the program names it.
constexpr std::array kOfMach3Too{std::string_view("g12"), std::string_view("g13"),
                                 std::string_view("g15"), std::string_view("g16"),
                                 std::string_view("g51"), std::string_view("g68"),
                                 kProgramNumber};

// Names of controllers, also in comments. Comments of Siemens and HEIDENHAIN follow ";".
constexpr std::array kNames{std::pair{"linuxcnc", Tongue::kLinuxcnc},
                            std::pair{"emc2", Tongue::kLinuxcnc},
                            std::pair{"grbl", Tongue::kGrbl},
                            std::pair{"mach3", Tongue::kMach3},
                            std::pair{"mach4", Tongue::kMach3},
                            std::pair{"haas", Tongue::kHaas},
                            std::pair{"fanuc", Tongue::kFanuc},
                            std::pair{"sinumerik", Tongue::kSiemens},
                            std::pair{"heidenhain", Tongue::kHeidenhain}};
constexpr int kNameWeight = 9;

struct Evidence {
  int score = 0;
  std::string first;  ///< "line 3 has G154"
};

bool is_foreign(Tongue tongue) {
  return tongue == Tongue::kSiemens || tongue == Tongue::kHeidenhain;
}

bool is_letter(char c) { return c >= 'a' && c <= 'z'; }

// A line in lower case, divided into code and comments: (…) and the text after ";".
class LineText {
 public:
  enum class Part { kCode, kSemicolon, kParentheses };

  explicit LineText(std::string_view line) {
    Part part = Part::kCode;
    for (const char written : line) {
      const char c = written == '\t' || written == '\r' ? ' ' : to_lower(written);
      if (c == '(' && part == Part::kCode) part = Part::kParentheses;
      if (c != ' ' && part == Part::kCode) code += c;
      if (c != ' ' || (!words_.empty() && words_.back() != ' ')) {
        words_ += c;
        // A word that ";" or "(" begins belongs to the code: ;$path=.
        parts_.push_back(part);
      }
      if (c == ';' && part == Part::kCode) part = Part::kSemicolon;
      if (c == ')' && part == Part::kParentheses) part = Part::kCode;
    }
    named_ = code.size() > 1 && (code[0] == 'o' || code[0] == ':') && is_digit(code[1]);
  }

  /// Whether the line has a word, not within a longer one, that begins in `last` or a part before.
  bool has_word(std::string_view word, Part last) const {
    if (last == Part::kCode && named_) return false;  // the rest is the name of a program
    for (std::size_t at = words_.find(word); at != std::string::npos;
         at = words_.find(word, at + 1)) {
      const std::size_t end = at + word.size();
      const bool joined = (at > 0 && is_letter(words_[at - 1]) && is_letter(word.front())) ||
                          (end < words_.size() && is_letter(words_[end]) && is_letter(word.back()));
      if (!joined && parts_[at] <= last) return true;
    }
    return false;
  }

  std::string code;  ///< without comments and blanks

 private:
  std::string words_;  ///< with single blanks
  std::vector<Part> parts_;
  bool named_ = false;
};

class Judge {
 public:
  void read(std::string_view text) {
    TextLines walk(text);
    for (std::size_t number = 1; walk.next() && number <= kLinesMax; ++number)
      weigh(walk.line(), number);
  }
  const Evidence& of(Tongue tongue) const { return evidence_[static_cast<std::size_t>(tongue)]; }
  /// The weight of the marks of Fanuc and Haas that Mach3 has too.
  int of_mach3_too() const { return of_mach3_too_; }
  void add(Tongue tongue, int weight, const std::string& what) {
    Evidence& evidence = evidence_[static_cast<std::size_t>(tongue)];
    if (evidence.score == 0) evidence.first = what;
    evidence.score += weight;
  }

 private:
  void weigh(std::string_view line, std::size_t number) {
    const LineText text(line);
    const std::string& code = text.code;
    const std::string place = "line " + std::to_string(number) + " has ";
    for (std::size_t i = 0; i < kMarks.size(); ++i) {
      const Mark& mark = kMarks[i];
      if (seen_mark_[i]) continue;
      const bool found = is_foreign(mark.tongue) ? text.has_word(mark.text, LineText::Part::kCode)
                                                 : has(code, mark);
      if (!found) continue;
      seen_mark_[i] = true;
      once(mark.tongue, mark.weight, place, mark.text);
    }
    if (assigns_r(code)) once(Tongue::kSiemens, 10, place, "an R parameter");
    for (const auto& [name, tongue] : kNames)
      if (text.has_word(
              name, is_foreign(tongue) ? LineText::Part::kSemicolon : LineText::Part::kParentheses))
        once(tongue, kNameWeight, place, name);
    if (starts_program(code)) once(Tongue::kFanuc, 4, place, kProgramNumber);
    if (is_o_word(code)) once(Tongue::kLinuxcnc, 20, place, "an O word");
    if (code.starts_with('$')) once(Tongue::kGrbl, 8, place, "a $ command");
  }

  // Each mark counts once.
  void once(Tongue tongue, int weight, const std::string& place, std::string_view what) {
    for (const auto& seen : seen_)
      if (seen.first == tongue && seen.second == what) return;
    seen_.emplace_back(tongue, what);
    if (std::ranges::find(kOfMach3Too, what) != kOfMach3Too.end()) of_mach3_too_ += weight;
    add(tongue, weight, place + to_upper(std::string(what)));
  }

  static bool has(const std::string& line, const Mark& mark) {
    for (std::size_t at = line.find(mark.text); at != std::string::npos;
         at = line.find(mark.text, at + 1)) {
      const char next = at + mark.text.size() < line.size() ? line[at + mark.text.size()] : '\0';
      if (!mark.code || mark.text.front() == ',' || (!is_digit(next) && next != '.')) return true;
    }
    return false;
  }
  // R1=5 of SINUMERIK.
  static bool assigns_r(const std::string& code) {
    for (std::size_t at = code.find('r'); at != std::string::npos; at = code.find('r', at + 1)) {
      std::size_t end = at + 1;
      while (end < code.size() && is_digit(code[end])) ++end;
      const bool joined = at > 0 && (is_letter(code[at - 1]) || code[at - 1] == ',');
      if (!joined && end > at + 1 && end < code.size() && code[end] == '=') return true;
    }
    return false;
  }
  // O1000, also with the program's name behind the number.
  static bool starts_program(const std::string& code) {
    if (code.size() < 2 || (code[0] != 'o' && code[0] != ':') || !is_digit(code[1])) return false;
    const auto end = code.find_first_not_of("0123456789;", 1);
    return end == std::string::npos || (is_letter(code[end]) && !is_o_word(code));
  }
  static bool is_o_word(const std::string& code) {
    if (code.size() < 3 || code[0] != 'o' || !is_digit(code[1])) return false;
    const auto end = code.find_first_not_of("0123456789", 1);
    if (end == std::string::npos) return false;
    // The word is followed by nothing or by arguments in brackets.
    const std::string_view rest = std::string_view(code).substr(end);
    const std::string_view word = rest.substr(0, rest.find_first_of("[;#"));
    for (const std::string_view known :
         {"sub", "endsub", "call", "return", "do", "while", "endwhile", "repeat", "endrepeat", "if",
          "elseif", "else", "endif", "break", "continue"})
      if (word == known) return true;
    return false;
  }

  std::array<Evidence, kTongues> evidence_;
  std::array<bool, kMarks.size()> seen_mark_{};
  int of_mach3_too_ = 0;
  std::vector<std::pair<Tongue, std::string_view>> seen_;
};

ProgramError foreign(const std::string& name, const std::string& language,
                     const Evidence& evidence) {
  return {name, 0, "",
          "is a program for " + language + " (" + evidence.first +
              "), which is not read; --dialect names those that are: " + dialect_names(),
          "auto"};
}

}  // namespace

std::expected<DialectChoice, ProgramError> choose_dialect(const std::string& name,
                                                          std::string_view text) {
  Judge judge;
  judge.read(text);
  if (to_lower(name).ends_with(".ngc")) judge.add(Tongue::kLinuxcnc, 3, "its name ends in .ngc");
  for (const char* extension : {".mpf", ".spf"})
    if (to_lower(name).ends_with(extension))
      judge.add(Tongue::kSiemens, 20, std::string("its name ends in ") + extension);
  // Marks that Haas and Fanuc share count for both.
  constexpr std::array kReadable{std::pair{Tongue::kLinuxcnc, Dialect::kLinuxcnc},
                                 std::pair{Tongue::kHaas, Dialect::kHaas},
                                 std::pair{Tongue::kFanuc, Dialect::kFanuc},
                                 std::pair{Tongue::kGrbl, Dialect::kGrbl},
                                 std::pair{Tongue::kMach3, Dialect::kMach3},
                                 std::pair{Tongue::kSiemens, Dialect::kSiemens}};
  const int haas = judge.of(Tongue::kHaas).score;
  const auto score = [&](Tongue tongue) {
    const int own = judge.of(tongue).score;
    if (tongue == Tongue::kMach3 && own > 0) return own + judge.of_mach3_too();
    return tongue == Tongue::kHaas && haas > 1 ? own + judge.of(Tongue::kFanuc).score : own;
  };
  DialectChoice choice{Dialect::kLinuxcnc, "no word of it points to one controller", true};
  int best = 0;
  for (const auto& [tongue, dialect] : kReadable) {
    if (score(tongue) <= best) continue;
    best = score(tongue);
    choice = {dialect, judge.of(tongue).first, false};
  }
  const Evidence& klartext = judge.of(Tongue::kHeidenhain);
  if (klartext.score >= 10 && klartext.score > best)
    return std::unexpected(foreign(name, "HEIDENHAIN Klartext", klartext));
  return choice;
}

}  // namespace kerf
