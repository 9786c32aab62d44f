// SPDX-License-Identifier: Apache-2.0
#include "server/log/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace kerf::log {

void open() {
  spdlog::set_default_logger(spdlog::stderr_color_mt("kerf"));
  spdlog::set_pattern("%Y-%m-%d %H:%M:%S.%e %^%l%$ %v");
}

// spdlog formats no text that is given as such: braces in it are harmless.
void info(std::string_view text) { spdlog::info(text); }
void warn(std::string_view text) { spdlog::warn(text); }
void error(std::string_view text) { spdlog::error(text); }

}  // namespace kerf::log
