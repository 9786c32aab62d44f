// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace kerf::arch {

/// One file of the repository: its path from the root, with forward slashes, and its text.
struct Source {
  std::string path;
  std::string text;
};

/// A violation of a rule: its location and the reason for the rule.
struct Violation {
  std::string path;
  std::size_t line = 0;  ///< from 1; 0 for the file or folder as a whole
  std::string reason;
};

/// The files that the rules look at, sorted by path: sources, build files, scripts and READMEs,
/// without build outputs and fetched packages.
std::vector<Source> load_tree(const std::filesystem::path& root);

/// Blanks out comments and the contents of literals. Lines and columns keep their positions.
std::string code_only(std::string_view text);

/// The lines of a text, without line ends.
std::vector<std::string_view> lines_of(std::string_view text);

/// Returns the number, from 1, of the line that contains this offset.
std::size_t line_at(std::string_view text, std::size_t offset);

bool is_cpp(std::string_view path);         ///< .h or .cpp
bool is_typescript(std::string_view path);  ///< .ts or .tsx
bool is_header(std::string_view path);      ///< .h
/// The folder of a path, without a slash at its end; empty at the root.
std::string_view folder_of(std::string_view path);

}  // namespace kerf::arch
