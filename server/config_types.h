// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace kerf {

/// Type of an option's value in a configuration file.
enum class ConfigType : std::uint8_t {
  kUnknown,  ///< not an option; reported by the reader of the file
  kBoolean,  ///< true or false
  kNumber,
  kText,   ///< in quotes
  kTexts,  ///< a list of texts, or one text
};

struct ConfigFault {
  std::size_t line = 0;  ///< from 1
  std::string reason;    ///< begins with the key if there is one
};

/// Checks the type of each `KEY = VALUE` of a TOML file, outside sections, because the parser of
/// the command line accepts "yes" for true, and a line without a value. Returns the first fault, or
/// nullopt.
std::optional<ConfigFault> check_types(std::string_view text,
                                       const std::function<ConfigType(std::string_view)>& type_of);

}  // namespace kerf
