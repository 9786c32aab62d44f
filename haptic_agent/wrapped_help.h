// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace CLI {
class App;
}

namespace kerf::agent {

/// Columns of the option names, to the left of the descriptions, on a terminal of 80 columns.
inline constexpr std::size_t kHelpNameColumns = 30;
inline constexpr std::size_t kHelpTextColumns = 80 - kHelpNameColumns;

/// Breaks lines between words, so that none is longer than kHelpTextColumns unless a word is. Line
/// breaks of the text are kept.
std::string wrapped(const std::string& text);

/// Wraps the descriptions of all options that the program has so far.
void wrap_help(CLI::App& app);

}  // namespace kerf::agent
