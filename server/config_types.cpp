// SPDX-License-Identifier: Apache-2.0
#include "server/config_types.h"

#include <utility>

#include "server/http/number.h"

namespace kerf {
namespace {

constexpr std::string_view kSpace = " \t\r";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kSpace);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) + 1 - first);
}

bool is_quote(char c) { return c == '"' || c == '\''; }

/// The lines of a file, in order.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  /// The next line without the space around it, or nullopt after the last one.
  std::optional<std::string_view> next() {
    if (rest_.empty()) return std::nullopt;
    const auto line = rest_.substr(0, rest_.find('\n'));
    rest_.remove_prefix(std::min(line.size() + 1, rest_.size()));
    ++number_;
    return trimmed(line);
  }
  std::size_t number() const { return number_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// The type of a value, or its fault.
struct Value {
  ConfigType type = ConfigType::kUnknown;  ///< kUnknown: a word without quotes
  std::string fault = {};
};

Value faulty(std::string fault) { return {ConfigType::kUnknown, std::move(fault)}; }

/// A text in quotes, possibly followed by a comment.
Value quoted_value(std::string_view text) {
  const auto end = text.find(text.front(), 1);
  if (end == text.npos) return faulty("has quotes that are not closed");
  if (text.substr(0, end).contains('#')) {
    return faulty("may not contain #: what follows would be a comment");
  }
  const auto behind = trimmed(text.substr(end + 1));
  if (!behind.empty() && behind.front() != '#') return faulty("has something behind its value");
  return {ConfigType::kText};
}

/// A list, which may continue on the next lines until one that ends with "]".
Value list_value(std::string_view first, Lines& lines) {
  std::string list(first);
  while (!list.ends_with(']')) {
    const auto more = lines.next();
    if (!more) return faulty("has a list that is not closed with ] at the end of a line");
    list += *more;
  }
  std::string_view rest = trimmed(std::string_view(list).substr(1, list.size() - 2));
  while (!rest.empty()) {
    const auto end = is_quote(rest.front()) ? rest.find(rest.front(), 1) : rest.npos;
    if (end == rest.npos) return faulty("must be a list of texts, each in quotes");
    rest = trimmed(rest.substr(end + 1));
    if (rest.empty()) break;
    if (rest.front() != ',') return faulty("must be a list of texts, with commas between them");
    rest = trimmed(rest.substr(1));
  }
  return {ConfigType::kTexts};
}

Value value_of(std::string_view text, Lines& lines) {
  if (text.empty()) return faulty("has no value");
  if (is_quote(text.front())) return quoted_value(text);
  if (text.front() == '[') return list_value(text, lines);
  const auto word = trimmed(text.substr(0, text.find('#')));
  if (word == "true" || word == "false") return {ConfigType::kBoolean};
  return {net::parse_number<double>(word) ? ConfigType::kNumber : ConfigType::kUnknown};
}

/// Why an option cannot have a value of that type, or an empty text.
std::string mismatch(ConfigType wanted, ConfigType given) {
  const bool fits = wanted == given || wanted == ConfigType::kUnknown ||
                    (wanted == ConfigType::kTexts && given == ConfigType::kText);
  if (fits) return "";
  switch (wanted) {
    case ConfigType::kBoolean:
      return "must be true or false, without quotes";
    case ConfigType::kNumber:
      return "must be a number, without quotes";
    case ConfigType::kText:
      return "must be a text in quotes";
    default:
      return "must be a list of texts in quotes, or one text";
  }
}

}  // namespace

std::optional<ConfigFault> check_types(std::string_view text,
                                       const std::function<ConfigType(std::string_view)>& type_of) {
  Lines lines(text);
  bool is_in_section = false;
  while (const auto line = lines.next()) {
    if (line->empty() || line->front() == '#' || line->front() == ';') continue;
    if (line->front() == '[' && line->back() == ']') {
      is_in_section = *line != "[default]";
      continue;
    }
    const std::size_t number = lines.number();
    const auto equals = line->find('=');
    std::string key(trimmed(line->substr(0, equals)));
    if (equals == line->npos) return ConfigFault{number, key + " has no value: write KEY = VALUE"};
    if (key.size() > 2 && is_quote(key.front()) && key.back() == key.front()) {
      key = key.substr(1, key.size() - 2);
    }
    const Value value = value_of(trimmed(line->substr(equals + 1)), lines);
    const ConfigType wanted = is_in_section ? ConfigType::kUnknown : type_of(key);
    const std::string fault = value.fault.empty() ? mismatch(wanted, value.type) : value.fault;
    if (!fault.empty()) return ConfigFault{number, key + " " + fault};
  }
  return std::nullopt;
}

}  // namespace kerf
