// SPDX-License-Identifier: Apache-2.0
#include "server/formats/tool_comment.h"

#include "server/formats/letter_case.h"
#include "server/formats/tool_lexicon.h"
#include "server/formats/tool_tokens.h"

namespace kerf {
namespace {

constexpr std::size_t kStatedDigitsMax = 6;

// Reads "T1", "TOOL 1", "TOOL NO. 1:", "TOOLS: T9", "#3": a number that is not a size.
class Head {
 public:
  explicit Head(std::string_view text) : text_(text) {}

  std::optional<ToolId> number() {
    skip(" \t*-");
    if (is_digit(at())) return listed();
    const bool named =
        word("TOOLS") || word("TOOL") || word("WERKZEUG") || word("OUTIL") || word("HERRAMIENTA");
    if (named) skip(" \t:-");
    if (word("NUMBER") || word("NO") || word("NR")) skip(" \t.:#-");
    const bool t = word("T") || at() == '#';
    if (!named && !t) return std::nullopt;
    skip(" \t:#-.=[");
    const ToolId id = digits();
    if (id == 0) return std::nullopt;
    // "TOOL 6MM", "TOOL 1/4", "TOOL 6.35": a size.
    if (at() == '/' || at() == '"' || at() == '\'' || is_size_after()) return std::nullopt;
    return id;
  }
  // "1 = End Mill {6 mm}" of Vectric.
  std::optional<ToolId> listed() {
    const ToolId id = digits();
    skip(" \t");
    return id > 0 && at() == '=' ? std::optional(id) : std::nullopt;
  }
  std::string_view rest() const { return text_.substr(at_); }

 private:
  ToolId digits() {
    ToolId id = 0;
    for (const std::size_t from = at_; is_digit(at()) && at_ - from < kStatedDigitsMax; ++at_)
      id = 10 * id + static_cast<ToolId>(at() - '0');
    return id;
  }
  char at(std::size_t more = 0) const {
    return at_ + more < text_.size() ? to_upper(text_[at_ + more]) : '\0';
  }
  void skip(std::string_view any) {
    while (at() != '\0' && any.find(at()) != std::string_view::npos) ++at_;
  }
  bool word(std::string_view upper) {
    for (std::size_t i = 0; i < upper.size(); ++i)
      if (at(i) != upper[i]) return false;
    const char next = at(upper.size());
    if (next >= 'A' && next <= 'Z') return false;
    at_ += upper.size();
    return true;
  }
  bool is_size_after() const {
    if (at() == '.') return is_digit(at(1));
    std::size_t more = 0;
    while (at(more) == ' ') ++more;
    return (at(more) == 'M' && at(more + 1) == 'M') ||
           (at(more) == 'I' && at(more + 1) == 'N' && (at(more + 2) < 'A' || at(more + 2) == 'C'));
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

// "#7 DRILL": a gauge.
bool is_gauge(std::string_view comment) {
  const std::vector<ToolToken> tokens = tool_tokens(comment);
  return tokens.size() > 2 && tokens[0].word == "#" && tokens[1].is_number() &&
         tool_word_meaning(tokens[2].word) == ToolWord::kDrill;
}

}  // namespace

std::optional<NumberedComment> numbered_comment(std::string_view comment) {
  if (is_gauge(comment)) return std::nullopt;
  Head head(comment);
  const auto id = head.number();
  if (!id) return std::nullopt;
  return NumberedComment{*id, head.rest()};
}

}  // namespace kerf
