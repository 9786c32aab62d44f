// SPDX-License-Identifier: Apache-2.0
#include "server/formats/heidenhain/blocks.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "server/formats/letter_case.h"
#include "server/formats/text_lines.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

bool is_letter(char c) { return c >= 'A' && c <= 'Z'; }
bool is_value(char c) { return is_digit(c) || c == '.' || c == ',' || c == '+' || c == '-'; }

// "+10,5", "-Q3", "QL12": a sign, then digits or a parameter; also a sign alone, as in DR+.
std::string read_value(std::string_view text, std::size_t& at) {
  std::string value;
  if (text[at] == '+' || text[at] == '-') value += text[at++];
  if (at < text.size() && text[at] == 'Q') {
    value += text[at++];
    if (at < text.size() && (text[at] == 'L' || text[at] == 'R')) value += text[at++];
  }
  for (; at < text.size() && (is_digit(text[at]) || text[at] == '.' || text[at] == ','); ++at)
    value += text[at] == ',' ? '.' : text[at];
  return value;
}

// Without comment and block number, in upper case with single blanks. Names in quotes are kept.
std::string clean(std::string_view line) {
  std::string text;
  bool quoted = false;
  for (const char written : line) {
    const char c = static_cast<unsigned char>(written) < ' ' ? ' ' : written;
    if (c == '"') quoted = !quoted;
    if (c == ';' && !quoted) break;
    if (c == ' ' && (text.empty() || text.back() == ' ')) continue;
    text += quoted ? c : to_upper(c);
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

std::string without_number(const std::string& text) {
  std::size_t end = 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  if (end == 0 || (end < text.size() && text[end] != ' ')) return text;
  return end < text.size() ? text.substr(end + 1) : std::string();
}

// "LBL 5", "LBL "NAME"", not LBL 0.
std::string label_of(const std::string& text) {
  if (!text.starts_with("LBL")) return {};
  const std::size_t from = text.find_first_not_of(' ', 3);
  const std::string name = from == std::string::npos ? "" : text.substr(from);
  return name == "0" ? "" : name;
}

// nullopt for a parameter, and for a sign alone.
std::optional<double> number_of(const KlartextWord& word) {
  if (std::ranges::none_of(word.value, is_digit)) return std::nullopt;
  char* end = nullptr;
  const double value = std::strtod(word.value.c_str(), &end);
  return *end == '\0' ? std::optional(value) : std::nullopt;
}

std::string first_block(std::string_view program) {
  TextLines walk(program);
  while (walk.next()) {
    const std::string text = without_number(clean(walk.line()));
    if (!text.empty() && text != "%") return text;
  }
  return {};
}

// Returns the corner in the words of a BLK FORM. Incremental coordinates are relative to `from`.
std::optional<Vec3> blank_corner(const std::vector<KlartextWord>& words, Vec3 from, double unit) {
  Vec3 corner;
  bool stated[3] = {};
  for (const KlartextWord& word : words) {
    const bool incremental = word.name.size() == 2 && word.name[0] == 'I';
    const char axis = word.name.empty() ? ' ' : word.name.back();
    if ((word.name.size() != 1 && !incremental) || axis < 'X' || axis > 'Z') return std::nullopt;
    if (word.value.empty() && &word == words.data()) continue;  // the axis of the tool
    const auto number = number_of(word);
    if (!number) return std::nullopt;
    const int at = axis - 'X';
    double& side = at == 0 ? corner.x : at == 1 ? corner.y : corner.z;
    const double base = at == 0 ? from.x : at == 1 ? from.y : from.z;
    side = unit * *number + (incremental ? base : 0);
    stated[at] = true;
  }
  return stated[0] && stated[1] && stated[2] ? std::optional(corner) : std::nullopt;
}

/// The blocks of a text, in order.
class BlockWalk {
 public:
  /// `line` is the number of the first line.
  explicit BlockWalk(std::string_view text, std::size_t line = 1)
      : text_(text), lines_(text), first_line_(line) {}

  /// Moves to the next block. Returns false at the end.
  bool next() {
    bool more = false;
    do {
      if (!lines_.next()) return false;
      block_ = {read_line(more, true), first_line_ + lines_.number() - 1};
      at_ = static_cast<std::size_t>(lines_.line().data() - text_.data());
    } while (!more && is_left_out(block_.text));
    first_size_ = block_.text.size();
    while (more && lines_.next()) block_.text += ' ' + read_line(more, false);
    return true;
  }
  KlartextBlock& block() { return block_; }
  /// Offset of the block's first line in the text, and the text of that line.
  std::size_t at() const { return at_; }
  std::string first_line() const { return block_.text.substr(0, first_size_); }
  std::size_t lines() const { return lines_.number(); }

 private:
  static bool is_left_out(const std::string& text) {
    return text.empty() || text[0] == '*' || text[0] == '/';
  }
  std::string read_line(bool& more, bool first) const {
    std::string text = clean(lines_.line());
    if (first) text = without_number(text);
    // The continuation mark of a line may follow its comment.
    const std::size_t last = lines_.line().find_last_not_of(" \t\r");
    more = last != std::string_view::npos && lines_.line()[last] == '~';
    while (!text.empty() && (text.back() == ' ' || text.back() == '~')) text.pop_back();
    return text;
  }

  std::string_view text_;
  TextLines lines_;
  std::size_t first_line_;
  KlartextBlock block_;
  std::size_t at_ = 0, first_size_ = 0;
};

}  // namespace

bool is_klartext(std::string_view program) { return first_block(program).starts_with("BEGIN PGM"); }

double klartext_unit_mm(std::string_view program) {
  return first_block(program).ends_with(" INCH") ? kMmPerInch : 1;
}

KlartextBlocks::KlartextBlocks(std::string_view program) : program_(program) {
  BlockWalk walk(program);
  for (; walk.next();) {
    const std::string label = label_of(walk.first_line());
    if (!label.empty()) labels_.emplace(label, size());
    if (labels_.size() > kKlartextLabelsMax)
      throw ProgramFault{walk.block().text, "is one label too many: a program may have " +
                                                std::to_string(kKlartextLabelsMax)};
    places_.push_back(walk.at());
    lines_.push_back(static_cast<std::uint32_t>(walk.block().line));
  }
  line_count_ = walk.lines();
}

KlartextBlock KlartextBlocks::operator[](std::size_t n) const {
  BlockWalk walk(program_.substr(places_[n]), lines_[n]);
  walk.next();
  return std::move(walk.block());
}

std::optional<std::size_t> KlartextBlocks::label(const std::string& name) const {
  const auto it = labels_.find(name);
  return it == labels_.end() ? std::nullopt : std::optional(it->second);
}

std::vector<KlartextWord> klartext_words(std::string_view text) {
  std::vector<KlartextWord> words;
  std::size_t at = 0;
  const auto skip = [&] {
    while (at < text.size() && text[at] == ' ') ++at;
  };
  for (skip(); at < text.size(); skip()) {
    KlartextWord word;
    while (at < text.size() && is_letter(text[at]) && text[at] != 'Q') word.name += text[at++];
    std::size_t value = at;
    while (value < text.size() && text[value] == ' ') ++value;
    if (value < text.size() && (is_value(text[value]) || text[value] == 'Q')) {
      at = value;
      word.value = read_value(text, at);
    }
    if (word.name.empty() && word.value.empty()) word.name = text[at++];
    words.push_back(std::move(word));
  }
  return words;
}

std::optional<StockShape> klartext_blank(std::string_view program) {
  BoxStock box;
  bool first = false, second = false;
  const double unit = klartext_unit_mm(program);
  for (BlockWalk walk(program); walk.next();) {
    const KlartextBlock& block = walk.block();
    if (!block.text.starts_with("BLK FORM")) continue;
    const bool low = block.text.starts_with("BLK FORM 0.1");
    if (!low && !block.text.starts_with("BLK FORM 0.2")) return std::nullopt;
    const auto words = klartext_words(std::string_view(block.text).substr(12));
    const auto corner = blank_corner(words, low ? Vec3{} : box.min_mm, unit);
    if (!corner) return std::nullopt;
    (low ? box.min_mm : box.max_mm) = *corner;
    (low ? first : second) = true;
    if (!first || !second) continue;
    const bool valid =
        box.min_mm.x < box.max_mm.x && box.min_mm.y < box.max_mm.y && box.min_mm.z < box.max_mm.z;
    return valid ? std::optional<StockShape>(box) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace kerf
