// SPDX-License-Identifier: Apache-2.0
#include "tests/arch/words.h"

#include <algorithm>
#include <array>
#include <ranges>
#include <regex>
#include <string>
#include <string_view>

namespace kerf::arch {
namespace {

struct Retired {
  std::string_view words;  ///< alternatives of a regular expression, lower case
  std::string_view instead;
};

constexpr Retired kRetired[] = {
    {"la"
     "nes?",
     "thread, executor or transport; the word is for SIMD only"},
    {"o"
     "we[ds]?|de"
     "bts?",
     "lazy, pending; resolve"},
    {"se"
     "ats?",
     "participant state"},
    {"bir"
     "ths",
     "the task of the thread"},
    {"refu"
     "sals?",
     "rejection or error"},
};

// The glossary, the rules' own samples, and folders in which a word has its technical meaning.
bool is_exempt(std::string_view path, std::string_view word) {
  static constexpr std::array<std::string_view, 5> kSimd = {
      "kernel/", "tests/kernel/", "tests/determinism/", "tests/support/", "tests/bench/"};
  if (path == "CONTRIBUTING.md" || path == "CHANGELOG.md") return true;
  if (path.starts_with("tests/arch/")) return true;
  if (word.starts_with("la") || word.starts_with("La")) {
    for (const std::string_view folder : kSimd) {
      if (path.starts_with(folder)) return true;
    }
  }
  return false;
}

// Matches the word alone, in snake_case (_word_) and in CamelCase (aWordB), singular or plural.
std::regex pattern_of(std::string_view words) {
  std::string camel;  // each alternative with a capital
  bool first = true;
  for (const char c : words) {
    camel += first ? static_cast<char>(c - 'a' + 'A') : c;
    first = c == '|';
  }
  const std::string lower(words);
  return std::regex("(^|[^A-Za-z])(" + lower + "|" + camel + ")($|[^A-Za-z])|[a-z0-9](" + camel +
                    ")($|[^a-z])|(^|[^A-Za-z])(" + camel + ")[A-Z]");
}

// Returns a fixed substring of each alternative, without its first letter, whose case varies. A
// line without any of them cannot match, and is found faster than by the expression.
std::vector<std::string> stems_of(std::string_view words) {
  std::vector<std::string> stems;
  for (const auto alternative : std::views::split(words, '|')) {
    std::string_view stem(alternative.begin(), alternative.end());
    const std::size_t end = std::min(stem.find_first_of("?["), stem.size());
    stem = stem.substr(0, end < stem.size() && stem[end] == '?' ? end - 1 : end);
    stems.emplace_back(stem.substr(1));
  }
  return stems;
}

struct Rule {
  std::regex pattern;
  std::vector<std::string> stems;
  std::string_view instead;
};

const std::vector<Rule>& rules() {
  static const std::vector<Rule> kRules = [] {
    std::vector<Rule> rules;
    for (const Retired& retired : kRetired) {
      rules.push_back({pattern_of(retired.words), stems_of(retired.words), retired.instead});
    }
    return rules;
  }();
  return kRules;
}

bool may_match(const Rule& rule, std::string_view line) {
  return std::ranges::any_of(rule.stems, [&](const auto& stem) { return line.contains(stem); });
}

std::string word_of(const std::cmatch& match) {
  for (const std::size_t group : {2U, 4U, 7U}) {
    if (match[group].matched) return match[group].str();
  }
  return match.str();
}

}  // namespace

std::vector<Violation> check_words(const Source& source) {
  std::vector<Violation> violations;
  std::size_t number = 0;
  for (const std::string_view line : lines_of(source.text)) {
    ++number;
    for (const Rule& rule : rules()) {
      if (!may_match(rule, line)) continue;
      std::cmatch match;
      if (!std::regex_search(line.data(), line.data() + line.size(), match, rule.pattern)) continue;
      const std::string word = word_of(match);
      if (is_exempt(source.path, word)) continue;
      violations.push_back(
          {source.path, number, "'" + word + "' is retired: " + std::string(rule.instead)});
    }
  }
  return violations;
}

}  // namespace kerf::arch
