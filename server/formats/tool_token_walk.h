// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "server/formats/tool_lexicon.h"
#include "server/formats/tool_tokens.h"

namespace kerf {

/// Returns whether a word is a kind of tool.
inline bool is_tool_kind(ToolWord word) {
  return word >= ToolWord::kBall && word <= ToolWord::kBit;
}

/// The tokens of a tool's description. The rule that explains a token claims it.
class ToolTokenWalk {
 public:
  ToolTokenWalk(std::vector<ToolToken> tokens, double unit_mm)
      : tokens_(std::move(tokens)), claimed_(tokens_.size(), false), unit_mm_(unit_mm) {}

 protected:
  bool is(std::size_t i, std::string_view word) const {
    return i < tokens_.size() && tokens_[i].word == word;
  }
  bool is_free_number(std::size_t i) const {
    return i < tokens_.size() && tokens_[i].is_number() && !claimed_[i];
  }
  ToolWord meaning(std::size_t i) const {
    if (i >= tokens_.size() || tokens_[i].is_number()) return ToolWord::kUnknown;
    return tool_word_meaning(tokens_[i].word);
  }
  bool is_sign(std::size_t i) const {
    return i < tokens_.size() && tokens_[i].word.size() == 1 &&
           std::string_view("=:.-+").find(tokens_[i].word) != std::string_view::npos;
  }
  double mm(std::size_t i) const {
    const double unit = tokens_[i].unit_mm > 0 ? tokens_[i].unit_mm : unit_mm_;
    return std::round(tokens_[i].value * unit * 1e6) / 1e6;
  }
  void claim(std::size_t from, std::size_t count = 1) {
    for (std::size_t i = from; i < from + count; ++i) claimed_[i] = true;
  }
  // The number after a word and its signs. `count` receives the signs and the number.
  std::optional<std::size_t> number_after(std::size_t i, std::size_t& count) const {
    std::size_t next = i + 1;
    while (is_sign(next)) ++next;
    if (!is_free_number(next)) return std::nullopt;
    count = next - i;
    return next;
  }
  // The number of a name: after it, or before it if only a blank separates them. A sign such as
  // "=", and `behind`, prefer the number after the name.
  std::optional<std::size_t> number_of(std::size_t i, bool behind) {
    std::size_t count = 0;
    const auto after = number_after(i, count);
    const bool before = i > 0 && is_free_number(i - 1);
    if (after && (behind || !before || count > 1)) {
      claim(i, count + 1);
      return after;
    }
    if (!before) return std::nullopt;
    claim(i - 1, 2);
    return i - 1;
  }
  // Whether a number has a sign of its own: "-6" and "=-6", but not "DIA-6".
  bool negative(std::size_t i) const {
    if (i == 0 || !tokens_[i].glued) return false;
    if (i == 1) return is(0, "-") || is(0, "+");
    return is(i - 1, "-") && is(i - 2, "=");
  }
  // The kind of tool after a number, if no other number comes before it.
  ToolWord next_noun(std::size_t i) const {
    for (++i; i < tokens_.size() && !tokens_[i].is_number(); ++i)
      if (is_tool_kind(meaning(i))) return meaning(i);
    return ToolWord::kUnknown;
  }
  ToolWord next_kind(std::size_t i) const {
    for (++i; i < tokens_.size(); ++i)
      if (is_tool_kind(meaning(i))) return meaning(i);
    return ToolWord::kUnknown;
  }
  bool has_meaning(ToolWord word) const {
    for (std::size_t i = 0; i < tokens_.size(); ++i)
      if (meaning(i) == word) return true;
    return false;
  }

  std::vector<ToolToken> tokens_;
  std::vector<bool> claimed_;
  double unit_mm_;  ///< unit of numbers without one
};

}  // namespace kerf
