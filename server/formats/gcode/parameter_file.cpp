// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/parameter_file.h"

#include <charconv>
#include <cmath>
#include <optional>

#include "server/formats/gcode/parameters.h"
#include "server/formats/text_lines.h"

namespace kerf {
namespace {

// Removes one number from the front of a text of numbers separated by blanks.
template <typename Number>
std::optional<Number> take(std::string_view& text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return std::nullopt;
  text.remove_prefix(first);
  if (text.starts_with('+')) text.remove_prefix(1);
  Number value{};
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec != std::errc{}) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()));
  return value;
}

}  // namespace

std::expected<std::map<int, double>, ProgramError> read_parameter_file(const std::string& name,
                                                                       std::string_view text) {
  std::map<int, double> parameters;
  TextLines lines(text);
  while (lines.next()) {
    std::string_view rest = lines.line();
    const auto number = take<int>(rest);
    const auto value = number ? take<double>(rest) : std::nullopt;
    if (!value) continue;
    const auto failure = [&](const std::string& reason) {
      return std::unexpected(ProgramError{name, lines.number(), std::to_string(*number), reason});
    };
    if (*number < 1 || *number > kGcodeParameterMax)
      return failure("must be a parameter number from 1 to " + std::to_string(kGcodeParameterMax));
    if (!std::isfinite(*value)) return failure("has no finite value");
    if (!parameters.empty() && parameters.rbegin()->first >= *number)
      return failure("must be greater than the parameter number before it, " +
                     std::to_string(parameters.rbegin()->first));
    parameters[*number] = *value;
  }
  return parameters;
}

}  // namespace kerf
