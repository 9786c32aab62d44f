// SPDX-License-Identifier: Apache-2.0
#include "server/formats/sinumerik/flow.h"

#include <algorithm>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/letter_case.h"
#include "server/formats/text_lines.h"

namespace kerf {
namespace {

std::string_view after(std::string_view text, std::string_view word) {
  return text.substr(skip_blanks(text, word.size()));
}

struct Structure {
  std::string_view head, end;
};
constexpr Structure kStructures[] = {{"IF", "ENDIF"},
                                     {"WHILE", "ENDWHILE"},
                                     {"FOR", "ENDFOR"},
                                     {"LOOP", "ENDLOOP"},
                                     {"REPEAT", "UNTIL"}};

// Removes the label of a line from the text and returns it, "N100" for its number.
std::string take_label(std::string& text) {
  std::string label;
  std::size_t end = 0;
  if (text.size() > 1 && (text[0] == 'N' || text[0] == ':') && is_digit(text[1])) {
    for (end = 1; end < text.size() && is_digit(text[end]);) ++end;
    label = text.substr(0, end);
    text.erase(0, skip_blanks(text, end));
  }
  for (end = 0; end < text.size() && is_sinumerik_name(text[end]);) ++end;
  const std::size_t colon = skip_blanks(text, end);
  if (end > 1 && colon < text.size() && text[colon] == ':' && text.substr(colon, 2) != ":=") {
    label = text.substr(0, end);
    text.erase(0, skip_blanks(text, colon + 1));
  }
  return label;
}

SinumerikLine clean(std::string_view written) {
  SinumerikLine line;
  bool quoted = false;
  for (std::size_t at = 0; at < written.size(); ++at) {
    const char c = static_cast<unsigned char>(written[at]) < ' ' ? ' ' : written[at];
    if (c == '"') quoted = !quoted;
    if (c == ';' && !quoted) {
      line.comment = std::string(written.substr(at + 1));
      break;
    }
    if (c == ' ' && line.text.empty()) continue;
    line.text += quoted ? c : to_upper(c);
  }
  while (!line.text.empty() && line.text.back() == ' ') line.text.pop_back();
  return line;
}

}  // namespace

SinumerikProgram::SinumerikProgram(std::string_view text) : text_(text) {
  TextLines walk(text);
  while (walk.next()) starts_.push_back(static_cast<std::size_t>(walk.line().data() - text.data()));
  const std::string upper = to_upper(std::string(text));
  if (upper.find("GOTO") != std::string::npos)
    for (std::size_t n = 0; n < size(); ++n) {
      std::string line = clean(written(n)).text;
      if (const std::string number = take_label(line); !number.empty())
        labels_[number].push_back(n);
    }
  const auto has = [&upper](std::string_view word) {
    return upper.find(word) != std::string::npos;
  };
  if (has("ELSE") || std::ranges::any_of(kStructures, [&](const Structure& structure) {
        return has(structure.head) || has(structure.end);
      }))
    match();
}

std::string_view SinumerikProgram::written(std::size_t n) const {
  const std::size_t end = n + 1 < size() ? starts_[n + 1] : text_.size();
  std::string_view line = text_.substr(starts_[n], end - starts_[n]);
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

SinumerikLine SinumerikProgram::line(std::size_t n) const {
  SinumerikLine line = clean(written(n));
  if (line.text.starts_with('/')) line.text.clear();  // block delete is on
  take_label(line.text);
  return line;
}

void SinumerikProgram::match() {
  std::vector<std::pair<std::size_t, const Structure*>> open;
  for (std::size_t n = 0; n < size(); ++n) {
    const std::string text = line(n).text;
    const auto unmatched = [n](std::string_view word) {
      return ProgramFault{std::string(word),
                          "in line " + std::to_string(n + 1) + " has no other end"};
    };
    if (begins_word(text, "ELSE")) {
      if (open.empty() || open.back().second->head != "IF") throw unmatched("ELSE");
      partners_[open.back().first] = n;
      open.back().first = n;
    }
    for (const Structure& structure : kStructures) {
      const bool jumps = structure.head == "IF" && text.find("GOTO") != std::string::npos;
      const bool repeats = structure.head == "REPEAT" && text != "REPEAT";
      if (begins_word(text, structure.head) && !jumps && !repeats) open.emplace_back(n, &structure);
      if (!begins_word(text, structure.end)) continue;
      if (open.empty() || open.back().second != &structure) throw unmatched(structure.end);
      partners_[open.back().first] = n;
      partners_[n] = open.back().first;
      open.pop_back();
    }
  }
  if (!open.empty())
    throw ProgramFault{std::string(open.back().second->head),
                       "in line " + std::to_string(open.back().first + 1) + " has no end"};
}

std::size_t SinumerikProgram::partner(std::size_t n) const {
  const auto found = partners_.find(n);
  if (found == partners_.end()) throw ProgramFault{line(n).text, "has no other end"};
  return found->second;
}

std::optional<std::size_t> SinumerikProgram::label(const std::string& name, std::size_t from,
                                                   char direction) const {
  const auto it = labels_.find(name);
  if (it == labels_.end()) return std::nullopt;
  const auto next = std::ranges::upper_bound(it->second, from);
  if (direction != 'B' && next != it->second.end()) return *next;
  if (direction != 'F' && next != it->second.begin()) return *std::prev(next);
  return std::nullopt;
}

std::optional<SinumerikLine> SinumerikFlow::next() {
  while (at_ < program_.size()) {
    if (left_-- == 0) throw ProgramFault{"", "the program executes too many lines"};
    SinumerikLine line = program_.line(at_++);
    if (!control(line.text)) return line;
  }
  return std::nullopt;
}

// GOTOF, GOTOB, GOTO, GOTOC. Returns false for any other text.
bool SinumerikFlow::jump(std::string_view text) {
  for (const std::string_view word : {"GOTOF", "GOTOB", "GOTOC", "GOTO"}) {
    if (!begins_word(text, word)) continue;
    const std::string target(after(text, word));
    const auto found = program_.label(target, at_ - 1, word.size() > 4 ? word[4] : ' ');
    if (!found && word == "GOTOC") return true;
    if (!found) throw ProgramFault{target, "is no label in this direction"};
    at_ = *found;
    return true;
  }
  return false;
}

bool SinumerikFlow::control(const std::string& text) {
  if (jump(text)) return true;
  const std::size_t here = at_ - 1;
  if (begins_word(text, "IF")) {
    const std::string_view rest = after(text, "IF");
    const std::size_t go = rest.find("GOTO");
    const bool holds = values_.of(rest.substr(0, go)) != 0;
    if (go != std::string_view::npos) {
      if (holds) jump(rest.substr(go));
    } else if (!holds) {
      at_ = program_.partner(here) + 1;
    }
    return true;
  }
  if (begins_word(text, "ELSE")) return at_ = program_.partner(here) + 1, true;
  if (begins_word(text, "ENDIF") || begins_word(text, "LOOP") || text == "REPEAT") return true;
  if (begins_word(text, "WHILE")) {
    if (values_.of(after(text, "WHILE")) == 0) at_ = program_.partner(here) + 1;
    return true;
  }
  if (begins_word(text, "ENDWHILE") || begins_word(text, "ENDLOOP"))
    return at_ = program_.partner(here), true;
  if (begins_word(text, "UNTIL")) {
    if (values_.of(after(text, "UNTIL")) == 0) at_ = program_.partner(here) + 1;
    return true;
  }
  if (begins_word(text, "FOR")) return begin_for(text), true;
  if (begins_word(text, "ENDFOR")) return end_for(), true;
  return false;
}

// FOR name = start TO end
double SinumerikFlow::limit_of(std::string_view head, std::string& name,
                               std::string_view& start) const {
  const std::string_view rest = after(head, "FOR");
  const std::size_t sign = rest.find('='), to = rest.find(" TO ");
  if (sign == std::string_view::npos || to == std::string_view::npos || to < sign)
    throw ProgramFault{std::string(head), "must be FOR name = value TO value"};
  name = std::string(rest.substr(0, sign));
  while (name.ends_with(' ')) name.pop_back();
  if (!values_.has(name)) throw ProgramFault{name, "is not a variable of the program"};
  start = rest.substr(sign + 1, to - sign - 1);
  return values_.of(rest.substr(to + 4));
}

void SinumerikFlow::begin_for(std::string_view text) {
  std::string name;
  std::string_view start;
  const double limit = limit_of(text, name, start);
  const double first = values_.of(start);
  values_.set(name, first);
  if (first > limit) at_ = program_.partner(at_ - 1) + 1;
}

void SinumerikFlow::end_for() {
  const std::size_t head = program_.partner(at_ - 1);
  std::string name;
  std::string_view start;
  const std::string text = program_.line(head).text;
  const double limit = limit_of(text, name, start);
  const double next = values_.of(name) + 1;
  values_.set(name, next);
  if (next <= limit) at_ = head + 1;
}

}  // namespace kerf
