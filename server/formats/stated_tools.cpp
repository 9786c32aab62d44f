// SPDX-License-Identifier: Apache-2.0
#include "server/formats/stated_tools.h"

#include <charconv>
#include <optional>
#include <vector>

#include "server/formats/apt/tools.h"
#include "server/formats/heidenhain/blocks.h"
#include "server/formats/letter_case.h"
#include "server/formats/number_text.h"
#include "server/formats/text_lines.h"
#include "server/formats/tool_words.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr std::size_t kStatedDigitsMax = 6;

// A line divided into its code, in upper case without blanks, and its comments.
struct Parts {
  std::string code;
  std::vector<std::string_view> comments;
};

Parts parts_of(std::string_view line) {
  Parts parts;
  std::size_t from = 0;
  int depth = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == ';' && depth == 0) {
      parts.comments.push_back(line.substr(i + 1));
      return parts;
    }
    if (c == '(' && depth++ == 0) from = i + 1;
    if (c == ')' && depth > 0 && --depth == 0)
      parts.comments.push_back(line.substr(from, i - from));
    if (depth == 0 && c > ' ' && c != ')') parts.code += to_upper(c);
  }
  if (depth > 0) parts.comments.push_back(line.substr(from));
  return parts;
}

// The same of a line of Klartext, where only ";" and "* -" begin a comment. The code has no block
// number; blanks between quotes are kept.
Parts klartext_parts_of(std::string_view line) {
  Parts parts;
  std::size_t at = line.find_first_not_of(" \t0123456789");
  bool quoted = false;
  for (; at < line.size(); ++at) {
    const char c = line[at];
    if (c == '"') quoted = !quoted;
    if (!quoted && (c == ';' || (c == '*' && parts.code.empty()))) {
      parts.comments.push_back(line.substr(at + 1));
      break;
    }
    if (c > ' ' || quoted) parts.code += quoted ? c : to_upper(c);
  }
  return parts;
}

// Reads "T1", "TOOL 1", "TOOL NO. 1:", "TOOLS: T9", "#3": a number that is not the size.
class Head {
 public:
  explicit Head(std::string_view text) : text_(text) {}

  std::optional<ToolId> number() {
    skip(" \t*-");
    const bool named = word("TOOLS") || word("TOOL");
    if (named) skip(" \t:-");
    if (word("NUMBER") || word("NO") || word("NR")) skip(" \t.:#-");
    const bool t = word("T") || at() == '#';
    if (!named && !t) return std::nullopt;
    skip(" \t:#-.=[");
    ToolId id = 0;
    const std::size_t from = at_;
    for (; is_digit(at()) && at_ - from < kStatedDigitsMax; ++at_)
      id = 10 * id + static_cast<ToolId>(at() - '0');
    if (id == 0 || at_ == from) return std::nullopt;
    // "TOOL 6MM", "TOOL 1/4", "TOOL 6.35": a size.
    if (at() == '/' || at() == '"' || at() == '\'' || is_size_after()) return std::nullopt;
    return id;
  }
  std::string_view rest() const { return text_.substr(at_); }

 private:
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

// The number behind a T of the code, the last one of the line.
std::optional<ToolId> tool_word(const std::string& code) {
  for (std::size_t i = code.size(); i-- > 0;) {
    if (code[i] != 'T' || (i > 0 && code[i - 1] >= 'A' && code[i - 1] <= 'Z')) continue;
    ToolId id = 0;
    std::size_t end = i + 1;
    for (; end < code.size() && is_digit(code[end]) && end - i <= kStatedDigitsMax; ++end)
      id = 10 * id + static_cast<ToolId>(code[end] - '0');
    if (end > i + 1 && id > 0) return id;
  }
  return std::nullopt;
}

bool has_feed(const std::string& code) {
  for (std::size_t i = 0; i + 1 < code.size(); ++i) {
    if (code[i] != 'G') continue;
    const std::size_t digit = code[i + 1] == '0' && i + 2 < code.size() ? i + 2 : i + 1;
    const char next = digit + 1 < code.size() ? code[digit + 1] : ' ';
    if (code[digit] >= '1' && code[digit] <= '3' && !is_digit(next) && next != '.') return true;
  }
  return false;
}

// A path of Klartext that is not a rapid.
bool feeds_klartext(const std::string& code) {
  if (code.find("FMAX") != std::string::npos) return false;
  if (code.starts_with("CYCLCALL")) return true;
  for (const std::string_view path : {"LP", "L", "CP", "CR", "CT", "C", "RND", "CHF"}) {
    if (!code.starts_with(path)) continue;
    const char next = code.size() > path.size() ? code[path.size()] : ' ';
    return std::string_view("XYZABCIPQRF+-0123456789").find(next) != std::string_view::npos &&
           !code.starts_with("CC") && !code.starts_with("CALL");
  }
  return false;
}

class Finder {
 public:
  explicit Finder(std::string_view program)
      : klartext_(is_klartext(program)), unit_mm_(program_unit_mm(program)) {
    TextLines walk(program);
    while (walk.next()) read(walk.line(), walk.number());
    found_.merge(defined_);
    if (tool_) return;
    if (loose_ && !found_.contains(1)) found_.emplace(1, *loose_);
  }
  std::map<ToolId, StatedTool> take() { return std::move(found_); }

 private:
  void read(std::string_view line, std::size_t number) {
    const Parts parts = klartext_ ? klartext_parts_of(line) : parts_of(line);
    for (const std::string_view comment : parts.comments) describe(comment, number);
    if (klartext_ && parts.code.starts_with("TOOLDEF")) define(parts.code, number);
    if (const auto id = klartext_ ? called_tool(parts.code) : tool_word(parts.code)) {
      tool_ = id;
      open_ = true;
    }
    if (open_ && loose_) {
      if (*tool_ > 0) found_.try_emplace(*tool_, *loose_);
      loose_.reset();
    }
    if (klartext_ ? feeds_klartext(parts.code) : has_feed(parts.code)) open_ = false;
  }

  // The tool of a TOOL CALL: its number, or the rank of its name; 0 for one that is not known from
  // the text. nullopt: the line calls none.
  std::optional<ToolId> called_tool(const std::string& code) {
    constexpr std::string_view kCall = "TOOLCALL";
    if (!code.starts_with(kCall)) return std::nullopt;
    const std::string_view tool = std::string_view(code).substr(kCall.size());
    if (tool.starts_with('"')) {
      const std::string name(tool.substr(0, tool.find('"', 1)));
      return names_.try_emplace(name, static_cast<ToolId>(names_.size() + 1)).first->second;
    }
    if (tool.starts_with('Q')) return ToolId{0};
    ToolId id = 0;
    std::size_t digits = 0;
    for (; digits < tool.size() && digits < kStatedDigitsMax && is_digit(tool[digits]); ++digits)
      id = 10 * id + static_cast<ToolId>(tool[digits] - '0');
    return digits > 0 ? std::optional(id) : std::nullopt;
  }

  // TOOL DEF 1 L+0 R+5 states a radius; how the tool ends only a comment can.
  void define(const std::string& code, std::size_t line) {
    const std::size_t radius_at = code.find('R');
    if (radius_at == std::string::npos) return;
    ToolId id = 0;
    double radius = 0;
    const auto [after, error] = std::from_chars(code.data() + 7, code.data() + radius_at, id);
    const char* number = code.data() + radius_at + 1;
    if (*number == '+') ++number;
    const auto read = std::from_chars(number, code.data() + code.size(), radius);
    if (error != std::errc() || *after != 'L' || read.ec != std::errc() || !(radius > 0)) return;
    const std::string words = "END MILL D=" + decimal_text(2 * radius, 6);
    if (const auto shape = tool_of_words(words, unit_mm_))
      defined_.try_emplace(id, StatedTool{*shape, line, "TOOL DEF"});
  }

  void describe(std::string_view comment, std::size_t line) {
    Head head(comment);
    if (const auto id = head.number()) {
      if (const auto shape = tool_of_words(head.rest(), unit_mm_))
        found_.try_emplace(*id, StatedTool{*shape, line});
      return;
    }
    if (!names_tool(comment) && !mentions_size(comment)) return;
    if (const auto shape = tool_of_words(comment, unit_mm_)) loose_ = StatedTool{*shape, line};
  }

  static bool mentions_size(std::string_view comment) {
    const std::string upper = to_upper(std::string(comment));
    const bool tool = upper.find("TOOL") != std::string::npos;
    return tool &&
           (upper.find("DIA") != std::string::npos || upper.find("MILL") != std::string::npos);
  }

  bool klartext_;
  double unit_mm_;
  std::map<std::string, ToolId> names_;  ///< of TOOL CALL "NAME", in order
  std::map<ToolId, StatedTool> found_, defined_;
  std::optional<StatedTool> loose_;
  std::optional<ToolId> tool_;
  bool open_ = false;
};

}  // namespace

double program_unit_mm(std::string_view program) {
  if (is_klartext(program)) return klartext_unit_mm(program);
  if (is_apt(program)) return apt_unit_mm(program);
  TextLines walk(program);
  while (walk.next()) {
    const std::string code = parts_of(walk.line()).code;
    for (std::size_t i = 0; i + 2 < code.size(); ++i) {
      if (code[i] != 'G') continue;
      const char next = i + 3 < code.size() ? code[i + 3] : ' ';
      if (is_digit(next) || next == '.') continue;
      const std::string_view digits = std::string_view(code).substr(i + 1, 2);
      if (digits == "20" || digits == "70") return kMmPerInch;
      if (digits == "21" || digits == "71") return 1;
    }
  }
  return 1;
}

std::map<ToolId, StatedTool> stated_tools(std::string_view program) {
  if (is_apt(program)) {
    std::map<ToolId, StatedTool> found;
    for (const auto& [id, tool] : apt_tools(program).tools)
      if (tool.shape) found.emplace(id, StatedTool{*tool.shape, tool.line, "CUTTER"});
    return found;
  }
  return Finder(program).take();
}

}  // namespace kerf
