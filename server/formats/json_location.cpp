// SPDX-License-Identifier: Apache-2.0
#include "server/formats/json_location.h"

#include <algorithm>
#include <charconv>

namespace kerf {
namespace {

/// A cursor in valid JSON text. Builds no document.
class JsonWalker {
 public:
  explicit JsonWalker(std::string_view text) : text_(text) { skip_blanks(); }

  std::size_t position() const { return at_; }

  /// Moves to the value of a member of the object at the cursor. Returns false, without moving, if
  /// there is no such member.
  bool enter_member(std::string_view name) {
    const std::size_t start = at_;
    if (peek() != '{') return false;
    ++at_;
    while (skip_blanks(), peek() == '"') {
      const std::size_t key = at_ + 1;
      skip_value();
      const std::string_view found = text_.substr(key, at_ - key - 1);
      skip_past(':');
      if (found == name) return true;
      skip_value();
      skip_blanks();
      if (peek() == ',') ++at_;
    }
    at_ = start;
    return false;
  }

  /// Like enter_member, for an item of the list at the cursor.
  bool enter_item(std::size_t index) {
    const std::size_t start = at_;
    if (peek() != '[') return false;
    ++at_;
    for (skip_blanks(); at_ < text_.size() && peek() != ']'; skip_blanks()) {
      if (index-- == 0) return true;
      skip_value();
      skip_blanks();
      if (peek() == ',') ++at_;
    }
    at_ = start;
    return false;
  }

 private:
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip_blanks() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }
  void skip_past(char c) {
    at_ = std::min(text_.find(c, at_), text_.size() - 1) + 1;
    skip_blanks();
  }
  void skip_string() {
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_)
      if (text_[at_] == '\\') ++at_;
    at_ = std::min(at_ + 1, text_.size());
  }
  void skip_value() {
    if (peek() == '"') return skip_string();
    int depth = 0;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '"') {
        skip_string();
        continue;
      }
      if (c == '{' || c == '[') ++depth;
      if (depth == 0 && (c == ',' || c == '}' || c == ']')) return;
      ++at_;
      if ((c == '}' || c == ']') && --depth == 0) return;
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

TextPlace place_of(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte);
  const auto lines = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  const std::size_t newline = before.rfind('\n');
  return {lines + 1,
          newline == std::string_view::npos ? before.size() + 1 : before.size() - newline};
}

TextPlace locate_json(std::string_view text, std::string_view path) {
  JsonWalker walker(text);
  while (!path.empty()) {
    bool found = false;
    if (path.front() == '[') {
      const std::size_t end = std::min(path.find(']'), path.size() - 1);
      std::size_t index = 0;
      std::from_chars(path.data() + 1, path.data() + end, index);
      found = walker.enter_item(index);
      path.remove_prefix(end + 1);
    } else {
      if (path.front() == '.') path.remove_prefix(1);
      const std::string_view name = path.substr(0, path.find_first_of(".["));
      found = walker.enter_member(name);
      path.remove_prefix(name.size());
      if (name.empty()) break;
    }
    if (!found) break;
  }
  return place_of(text, walker.position());
}

}  // namespace kerf
