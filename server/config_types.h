// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace kerf {

/// What an option takes as its value in a configuration file.
enum class ConfigType : std::uint8_t {
  kUnknown,  ///< there is no such option; who reads the file says so
  kBoolean,  ///< true or false
  kNumber,
  kText,   ///< in quotes
  kTexts,  ///< a list of texts, or one text
};

struct ConfigFault {
  std::size_t line = 0;  ///< from 1
  std::string reason;    ///< begins with the key where there is one
};

/// Checks each `KEY = VALUE` of a file in TOML, outside of sections, for the type of its option;
/// the parser of the command line takes "yes" for true, and a line without a value too. Returns the
/// first fault; nullopt: there is none.
std::optional<ConfigFault> check_types(std::string_view text,
                                       const std::function<ConfigType(std::string_view)>& type_of);

}  // namespace kerf
