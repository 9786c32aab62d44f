// SPDX-License-Identifier: Apache-2.0
#include "server/formats/sinumerik/block.h"

#include <charconv>
#include <cmath>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/letter_case.h"
#include "server/formats/number_text.h"

namespace kerf {
namespace {

bool is_letter(char c) { return is_sinumerik_name(c) && !is_digit(c); }

class Words {
 public:
  Words(std::string_view text, const SinumerikValues& values) : text_(text), values_(values) {}

  std::vector<SinumerikWord> all() {
    std::vector<SinumerikWord> words;
    for (skip(); at_ < text_.size(); skip()) words.push_back(next());
    return words;
  }

 private:
  SinumerikWord next() {
    if (!is_letter(text_[at_]))
      throw ProgramFault{std::string(text_.substr(at_)), "does not begin a word"};
    std::size_t letters = at_;
    while (letters < text_.size() && is_letter(text_[letters])) ++letters;
    std::size_t end = letters;
    while (end < text_.size() && is_digit(text_[end])) ++end;
    const bool one_letter = letters == at_ + 1;
    // A3=…, S1=… and R1=… are addresses; G0X1 are two words.
    if (one_letter && !assigns(end)) return plain(letters);
    while (!one_letter && end < text_.size() && is_sinumerik_name(text_[end])) ++end;
    SinumerikWord word{.name = std::string(text_.substr(at_, end - at_))};
    at_ = end;
    if (assigns(at_)) {
      at_ = skip_blanks(text_, at_) + 1;
      assigned(word);
    } else if (const std::size_t open = skip_blanks(text_, at_);
               open < text_.size() && text_[open] == '(') {
      at_ = open;
      word.kind = SinumerikWord::Kind::kCall;
      word.text = in_parentheses();
    } else if (at_ < text_.size() && text_[at_] == '[') {
      throw ProgramFault{word.name + "[", "is an array, which is not supported"};
    }
    return word;
  }

  // R[…]
  void index(std::string& name) {
    const std::size_t close = text_.find(']', at_);
    if (close == std::string_view::npos) throw ProgramFault{name + "[", "lacks ']'"};
    const double number = values_.of(text_.substr(at_ + 1, close - at_ - 1));
    if (!(number >= 0 && number < 1e5)) throw ProgramFault{"R[", "has an index out of range"};
    name += std::to_string(static_cast<long>(number));
    at_ = close + 1;
  }

  // A letter and a number: X10, G0, M-5.
  SinumerikWord plain(std::size_t number) {
    SinumerikWord word{.name = std::string(1, text_[at_])};
    if (word.name == "R" && number < text_.size() && text_[number] == '[') {
      at_ = number;
      index(word.name);
      if (!assigns(at_)) throw ProgramFault{word.name, "is not assigned"};
      at_ = skip_blanks(text_, at_) + 1;
      assigned(word);
      return word;
    }
    std::size_t from = skip_blanks(text_, number);
    if (from < text_.size() && text_[from] == '+') ++from;
    const auto read = number_of_chars(text_.data() + from, text_.data() + text_.size(), word.value,
                                      std::chars_format::fixed);
    at_ = number;
    if (read.ec != std::errc() || !std::isfinite(word.value)) return word;
    at_ = static_cast<std::size_t>(read.ptr - text_.data());
    word.kind = SinumerikWord::Kind::kValue;
    return word;
  }

  bool assigns(std::size_t from) const {
    const std::size_t sign = skip_blanks(text_, from);
    return sign < text_.size() && text_[sign] == '=' &&
           (sign + 1 >= text_.size() || text_[sign + 1] != '=');
  }

  void assigned(SinumerikWord& word) {
    skip();
    if (at_ < text_.size() && text_[at_] == '"') {
      const std::size_t end = text_.find('"', at_ + 1);
      if (end == std::string_view::npos)
        throw ProgramFault{word.name, "has a text without its end"};
      word.kind = SinumerikWord::Kind::kText;
      word.text = std::string(text_.substr(at_ + 1, end - at_ - 1));
      at_ = end + 1;
      return;
    }
    word.kind = SinumerikWord::Kind::kValue;
    for (const std::string_view how : {"AC(", "IC(", "DC(", "ACP(", "ACN("}) {
      if (!text_.substr(at_).starts_with(how)) continue;
      if (how == "ACP(" || how == "ACN(")
        throw ProgramFault{word.name, "with ACP or ACN is not supported; use AC, IC or DC"};
      word.how = how == "IC(" ? SinumerikWord::How::kIncremental : SinumerikWord::How::kAbsolute;
      at_ += how.size() - 1;
      word.value = values_.of(in_parentheses());
      return;
    }
    word.value = values_.expression(text_, at_);
  }

  std::string in_parentheses() {
    int depth = 0;
    bool quoted = false;
    for (std::size_t end = at_; end < text_.size(); ++end) {
      if (text_[end] == '"') quoted = !quoted;
      if (quoted) continue;
      if (text_[end] == '(') ++depth;
      if (text_[end] != ')' || --depth > 0) continue;
      std::string inside(text_.substr(at_ + 1, end - at_ - 1));
      at_ = end + 1;
      return inside;
    }
    throw ProgramFault{std::string(text_.substr(at_)), "lacks ')'"};
  }

  void skip() { at_ = skip_blanks(text_, at_); }

  std::string_view text_;
  const SinumerikValues& values_;
  std::size_t at_ = 0;
};

}  // namespace

std::vector<SinumerikWord> sinumerik_words(std::string_view block, const SinumerikValues& values) {
  return Words(block, values).all();
}

std::vector<std::optional<double>> sinumerik_arguments(std::string_view text,
                                                       const SinumerikValues& values) {
  std::vector<std::optional<double>> arguments;
  int depth = 0;
  bool quoted = false;
  std::size_t from = 0;
  for (std::size_t at = 0; at <= text.size(); ++at) {
    const char c = at < text.size() ? text[at] : ',';
    if (c == '"') quoted = !quoted;
    if (c == '(' && !quoted) ++depth;
    if (c == ')' && !quoted) --depth;
    if (at < text.size() && (c != ',' || depth > 0 || quoted)) continue;
    const std::string_view one = text.substr(from, at - from);
    const std::size_t first = skip_blanks(one, 0);
    from = at + 1;
    if (first == one.size()) {
      arguments.emplace_back();
    } else {
      arguments.emplace_back(one[first] == '"' ? 0.0 : values.of(one));
    }
  }
  return arguments;
}

}  // namespace kerf
