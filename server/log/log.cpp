// SPDX-License-Identifier: Apache-2.0
#include "server/log/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <array>
#include <cstdio>

namespace kerf::log {
namespace {

Format chosen = Format::kText;

void write(spdlog::level::level_enum level, std::string_view text) {
  // spdlog does not format a plain text argument, so braces in it are harmless.
  if (chosen == Format::kText) return spdlog::log(level, text);
  spdlog::log(level, std::string_view(escaped(text)));
}

}  // namespace

void open(Format format) {
  chosen = format;
  spdlog::drop("kerf");  // from an earlier call
  spdlog::set_default_logger(spdlog::stderr_color_mt("kerf"));
  if (format == Format::kText) {
    spdlog::set_pattern("%Y-%m-%d %H:%M:%S.%e %^%l%$ %v");
  } else {
    spdlog::set_pattern(R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l","message":"%v"})",
                        spdlog::pattern_time_type::utc);
  }
}

void info(std::string_view text) { write(spdlog::level::info, text); }
void warn(std::string_view text) { write(spdlog::level::warn, text); }
void error(std::string_view text) { write(spdlog::level::err, text); }

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte == '"' || byte == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20) {
      std::array<char, 8> code{};
      std::snprintf(code.data(), code.size(), "\\u%04x", unsigned{byte});
      out += code.data();
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace kerf::log
