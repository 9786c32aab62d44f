// SPDX-License-Identifier: Apache-2.0
#include "server/formats/apt/statement.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "server/formats/letter_case.h"
#include "server/formats/number_text.h"

namespace kerf {
namespace {

constexpr std::string_view kCreo = "$$->";  ///< begins Creo's comments with data
/// Lines in which is_apt looks for a statement.
constexpr std::size_t kLookedAtMax = 200;
/// Statements with free text, including '$' and '/'.
constexpr std::array<std::string_view, 9> kTexts{"PARTNO", "PPRINT", "REMARK", "INSERT", "TPRINT",
                                                 "PPFUN",  "LETTER", "DISPLY", "LEADER"};
/// Statements that only APT has.
constexpr std::array<std::string_view, 9> kTypical{
    "GOTO", "FEDRAT", "LOADTL", "TLDATA", "UNITS", "SPINDL", "CUTTER", "TOOLPATH", "MULTAX"};

std::string clean(std::string_view text) {
  std::string result;
  for (const char c : text)
    if (static_cast<unsigned char>(c) > ' ') result += to_upper(c);
  return result;
}

// The free text after a major word, with its blanks.
std::string free_text(std::string_view line, std::size_t letters) {
  std::size_t at = 0;
  for (; at < line.size() && letters > 0; ++at)
    if (static_cast<unsigned char>(line[at]) > ' ') --letters;
  line.remove_prefix(std::min(line.find_first_not_of(" \t/", at), line.size()));
  line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
  return std::string(line);
}

std::vector<std::string> minor_words(std::string_view text) {
  std::vector<std::string> words;
  while (true) {
    const std::size_t comma = text.find(',');
    words.emplace_back(text.substr(0, comma));
    if (comma == std::string_view::npos) return words;
    text.remove_prefix(comma + 1);
  }
}

std::string_view major_of(std::string_view statement) {
  return statement.substr(0, statement.find('/'));
}

}  // namespace

bool AptStatements::next_line() {
  if (!lines_.next()) return false;
  line_ = lines_.number();
  return true;
}

std::optional<AptStatement> AptStatements::next() {
  while (true) {
    std::string text;
    if (ahead_) {
      text = *std::move(ahead_);
      ahead_.reset();
      line_ = ahead_line_;
    } else {
      if (!next_line()) return std::nullopt;
      text = clean(lines_.line());
    }
    if (text.starts_with(kCreo)) creo_ = true;
    // Creo states the diameter of its cutter in such a comment.
    if (text.starts_with(std::string(kCreo) + "CUTTER/")) text.erase(0, kCreo.size());
    for (const std::string_view word : kTexts)
      if (text.starts_with(word))
        return AptStatement{.major = std::string(word),
                            .minor = {},
                            .text = free_text(lines_.line(), word.size()),
                            .is_text = true,
                            .creo = creo_};
    std::size_t looked = 0;  // long statements are searched once
    while (true) {
      if (const std::size_t comment = text.find("$$", looked); comment != std::string::npos)
        text.erase(comment);
      if (!text.ends_with('$')) break;
      text.pop_back();
      if (!lines_.next()) throw ProgramFault{"$", "the statement is continued, but the file ends"};
      std::string more = clean(lines_.line());
      if (more.starts_with("GOTO/")) {
        ahead_ = std::move(more);
        ahead_line_ = lines_.number();
        break;
      }
      looked = text.size();
      text += more;
    }
    if (text.empty()) continue;
    AptStatement statement{.major = std::string(major_of(text)), .minor = {}, .creo = creo_};
    if (const std::size_t slash = text.find('/'); slash != std::string::npos)
      statement.minor = minor_words(std::string_view(text).substr(slash + 1));
    if (statement.minor.size() == 1 && statement.minor.front().empty()) statement.minor.clear();
    return statement;
  }
}

std::optional<double> apt_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto read = number_of_chars(word.data(), word.data() + word.size(), value);
  if (read.ec != std::errc{} || read.ptr != word.data() + word.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

double apt_number_of(const std::string& word) {
  const auto value = apt_number(word);
  if (!value) throw ProgramFault{word, word.empty() ? "a number is missing" : "is not a number"};
  return *value;
}

bool is_apt(std::string_view text) {
  TextLines lines(text);
  for (std::size_t looked = 0; looked < kLookedAtMax && lines.next(); ++looked) {
    const std::string line = clean(lines.line());
    const std::size_t slash = line.find('/');
    if (slash == std::string::npos) continue;
    if (std::ranges::find(kTypical, major_of(line)) != kTypical.end()) return true;
  }
  return false;
}

}  // namespace kerf
