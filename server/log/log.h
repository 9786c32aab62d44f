// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// The log of the server, on stderr: one line per event, with time and level. Callable on every
/// thread. spdlog is included in log.cpp alone, because each file with it takes seconds to compile.
namespace kerf::log {

/// Sets the format of the lines; called once, before the first thread starts.
void open();
void info(std::string_view text);
void warn(std::string_view text);
void error(std::string_view text);

}  // namespace kerf::log
