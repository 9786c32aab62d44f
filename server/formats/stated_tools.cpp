// SPDX-License-Identifier: Apache-2.0
#include "server/formats/stated_tools.h"

#include <charconv>
#include <optional>
#include <utility>
#include <vector>

#include "server/formats/apt/tools.h"
#include "server/formats/heidenhain/blocks.h"
#include "server/formats/letter_case.h"
#include "server/formats/number_text.h"
#include "server/formats/pycam_settings.h"
#include "server/formats/text_lines.h"
#include "server/formats/tool_comment.h"
#include "server/formats/tool_text.h"
#include "server/formats/tool_words.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

constexpr std::size_t kCalledDigitsMax = 6;

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

// The same for a line of Klartext, in which only ";" and "* -" begin a comment. The code has no
// block number. Blanks between quotes are kept.
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

// The number after the last T of a line's code.
std::optional<ToolId> tool_word(const std::string& code) {
  for (std::size_t i = code.size(); i-- > 0;) {
    if (code[i] != 'T' || (i > 0 && code[i - 1] >= 'A' && code[i - 1] <= 'Z')) continue;
    ToolId id = 0;
    std::size_t end = i + 1;
    for (; end < code.size() && is_digit(code[end]) && end - i <= kCalledDigitsMax; ++end)
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

StatedTool exported(const ToolShape& shape, std::size_t line) {
  constexpr Origin kStated = Origin::kStated;
  return {.shape = shape, .line = line, .origins = {kStated, kStated, kStated, kStated}};
}

// The tools in the head of an APT program that Kerf has written.
std::map<ToolId, StatedTool> exported_tools(std::string_view apt) {
  constexpr std::string_view kComment = "$$ ";
  std::map<ToolId, StatedTool> found;
  ExportedTools reader;
  TextLines walk(apt);
  while (walk.next()) {
    if (!walk.line().starts_with(kComment)) continue;
    const auto numbered = numbered_comment(walk.line().substr(kComment.size()));
    std::optional<ToolShape> shape;
    if (numbered && reader.add(numbered->id, numbered->rest, shape) && shape)
      found.insert_or_assign(numbered->id, exported(*shape, walk.number()));
  }
  return found;
}

class Finder {
 public:
  Finder(std::string_view program, double unit_mm)
      : klartext_(is_klartext(program)), unit_mm_(unit_mm) {
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
    const auto id = klartext_ ? called_tool(parts.code) : tool_word(parts.code);
    selected_ = open_ || id;
    for (const std::string_view comment : parts.comments) describe(comment, number);
    if (klartext_ && parts.code.starts_with("TOOLDEF")) define(parts.code, number);
    if (id) {
      tool_ = id;
      open_ = true;
    }
    if (open_ && loose_) {
      if (*tool_ > 0) keep(*tool_, *loose_);
      loose_.reset();
    }
    if (klartext_ ? feeds_klartext(parts.code) : has_feed(parts.code)) open_ = false;
  }

  // Returns the tool of a TOOL CALL: its number, or the rank of its name, or 0 if the text does not
  // determine it, or nullopt without a call.
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
    for (; digits < tool.size() && digits < kCalledDigitsMax && is_digit(tool[digits]); ++digits)
      id = 10 * id + static_cast<ToolId>(tool[digits] - '0');
    return digits > 0 ? std::optional(id) : std::nullopt;
  }

  // TOOL DEF 1 L+0 R+5 states a radius. Only a comment can describe the tip.
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
    constexpr ToolOrigins kOrigins{.diameter = Origin::kDerived};
    if (const auto tool = tool_of_words(words, unit_mm_))
      defined_.try_emplace(
          id, StatedTool{
                  .shape = tool->shape, .line = line, .source = "TOOL DEF", .origins = kOrigins});
  }

  void describe(std::string_view comment, std::size_t line) {
    if (pycam_.read(comment)) {
      const auto words = pycam_.take_tool();
      const auto tool = words ? tool_of_words(*words, unit_mm_) : std::nullopt;
      if (tool) loose_ = stated(*tool, line);
      if (tool) loose_->origins.diameter = Origin::kDerived;  // from the radius
      return;
    }
    if (const auto numbered = numbered_comment(comment)) {
      std::optional<ToolShape> exact;
      if (exported_.add(numbered->id, numbered->rest, exact)) {
        if (exact) found_.insert_or_assign(numbered->id, exported(*exact, line));
      } else if (const auto tool = tool_of_words(numbered->rest, unit_mm_)) {
        keep(numbered->id, stated(*tool, line));
      }
      return;
    }
    const auto tool = tool_of_words(comment, unit_mm_);
    if (!tool || !is_of_a_tool(*tool)) return;
    const bool worse = loose_ && loose_->doubt.empty() && !tool->doubt.empty();
    if (worse) return;
    const auto before = std::exchange(loose_, stated(*tool, line));
    if (before && before->doubt.empty() && tool_text(before->shape) != tool_text(tool->shape))
      loose_->doubt = "line " + std::to_string(before->line) + " describes another tool";
  }

  // The first description counts, unless it is doubtful and a later one is not.
  void keep(ToolId id, const StatedTool& tool) {
    const auto [known, added] = found_.try_emplace(id, tool);
    if (!added && !known->second.doubt.empty() && tool.doubt.empty()) known->second = tool;
  }

  // A comment without a number describes the selected tool, or it names one. "FACE 1" and "DRILL 5"
  // are operations.
  bool is_of_a_tool(const WordedTool& tool) const {
    if (selected_ && tool.sized) return tool.doubt.empty() || tool.names_kind;
    return tool.names_tool && tool.sized;
  }

  static StatedTool stated(const WordedTool& tool, std::size_t line) {
    return {.shape = tool.shape, .line = line, .origins = tool.origins, .doubt = tool.doubt};
  }

  bool klartext_;
  double unit_mm_;
  std::map<std::string, ToolId> names_;  ///< of TOOL CALL "NAME", in order
  std::map<ToolId, StatedTool> found_, defined_;
  ExportedTools exported_;
  PycamSettings pycam_;
  std::optional<StatedTool> loose_;
  std::optional<ToolId> tool_;
  bool open_ = false;
  bool selected_ = false;  ///< the line selects a tool, or no feed has followed one that did
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

std::map<ToolId, StatedTool> stated_tools(std::string_view program, double unit_mm) {
  if (is_apt(program)) {
    constexpr ToolOrigins kOrigins{Origin::kDerived, Origin::kStated, Origin::kStated,
                                   Origin::kStated};
    std::map<ToolId, StatedTool> found = exported_tools(program);
    for (const auto& [id, tool] : apt_tools(program).tools)
      if (tool.shape)
        found.emplace(
            id,
            StatedTool{
                .shape = *tool.shape, .line = tool.line, .source = "CUTTER", .origins = kOrigins});
    return found;
  }
  return Finder(program, unit_mm).take();
}

}  // namespace kerf
