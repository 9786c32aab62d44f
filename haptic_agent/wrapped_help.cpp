// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/wrapped_help.h"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace kerf::agent {

std::string wrapped(const std::string& text) {
  std::string lines;
  std::size_t column = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
    const std::size_t size = end - at;
    if (column > 0 && column + 1 + size > kHelpTextColumns) {
      lines += '\n';
      column = 0;
    }
    if (column > 0) lines += ' ';
    column += (column > 0 ? 1 : 0) + size;
    lines += text.substr(at, size);
    if (end < text.size() && text[end] == '\n') {
      lines += '\n';
      column = 0;
    }
    at = end + 1;
  }
  return lines;
}

void wrap_help(CLI::App& app) {
  app.get_formatter()->column_width(kHelpNameColumns);
  for (CLI::Option* option : app.get_options()) {
    option->description(wrapped(option->get_description()));
  }
}

}  // namespace kerf::agent
