// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

/// The log of the server, on stderr: one line per event, with time and level. Callable on every
/// thread. spdlog is included in log.cpp alone, because each file with it takes seconds to compile.
namespace kerf::log {

enum class Format {
  kText,  ///< for people, in local time
  kJson,  ///< an object per line: time (UTC, ISO 8601), level, message
};

/// Sets the format of the lines; called before the first thread starts.
void open(Format format = Format::kText);
void info(std::string_view text);
void warn(std::string_view text);
void error(std::string_view text);

/// Returns `text` as the inside of a JSON string. Non-ASCII bytes are unchanged.
std::string escaped(std::string_view text);

}  // namespace kerf::log
