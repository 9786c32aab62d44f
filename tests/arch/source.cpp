// SPDX-License-Identifier: Apache-2.0
#include "tests/arch/source.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

namespace kerf::arch {
namespace {

namespace fs = std::filesystem;

bool is_checked(const fs::path& path) {
  static const std::set<std::string> kSuffixes = {".h",    ".cpp",        ".ts", ".tsx", ".mjs",
                                                  ".py",   ".sh",         ".md", ".txt", ".css",
                                                  ".html", ".Dockerfile", ".svg"};
  return kSuffixes.contains(path.extension().string());
}

bool is_skipped(const fs::path& folder) {
  static const std::set<std::string> kSkipped = {"build", "node_modules", "dist", "out", ".git"};
  return kSkipped.contains(folder.filename().string());
}

// Returns one past the end of the literal or comment that begins at `at`; `at` itself if none does.
std::size_t end_of_blank(std::string_view text, std::size_t at) {
  const auto past = [&](std::string_view mark, std::size_t from) {
    const std::size_t found = text.find(mark, from);
    return found == text.npos ? text.size() : found + mark.size();
  };
  const std::string_view rest = text.substr(at);
  if (rest.starts_with("//")) return std::min(text.find('\n', at), text.size());
  if (rest.starts_with("/*")) return past("*/", at + 2);
  if (rest.starts_with("R\"")) {
    const std::string_view mark = rest.substr(2, rest.find('(') - 2);
    return past(")" + std::string(mark) + "\"", at);
  }
  const char quote = rest.front();
  const bool separator =
      quote == '\'' && at > 0 && std::isalnum(static_cast<unsigned char>(text[at - 1]));
  if ((quote != '"' && quote != '\'') || separator) return at;
  std::size_t i = at + 1;
  while (i < text.size() && text[i] != quote && text[i] != '\n') i += text[i] == '\\' ? 2 : 1;
  return std::min(i + 1, text.size());
}

}  // namespace

std::vector<Source> load_tree(const fs::path& root) {
  std::vector<Source> tree;
  for (fs::recursive_directory_iterator it(root), end; it != end; ++it) {
    if (it->is_directory() && is_skipped(it->path())) it.disable_recursion_pending();
    if (!it->is_regular_file() || !is_checked(it->path())) continue;
    std::ifstream file(it->path(), std::ios::binary);
    tree.push_back({fs::relative(it->path(), root).generic_string(),
                    std::string(std::istreambuf_iterator<char>(file), {})});
  }
  std::ranges::sort(tree, {}, &Source::path);
  return tree;
}

std::string code_only(std::string_view text) {
  std::string code(text);
  for (std::size_t i = 0; i < code.size();) {
    const std::size_t end = end_of_blank(text, i);
    if (end == i) ++i;
    for (; i < end; ++i) {
      if (code[i] != '\n') code[i] = ' ';
    }
  }
  return code;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::size_t line_at(std::string_view text, std::size_t offset) {
  return 1 + static_cast<std::size_t>(std::ranges::count(text.substr(0, offset), '\n'));
}

bool is_header(std::string_view path) { return path.ends_with(".h"); }
bool is_cpp(std::string_view path) { return is_header(path) || path.ends_with(".cpp"); }
bool is_typescript(std::string_view path) {
  return path.ends_with(".ts") || path.ends_with(".tsx");
}

std::string_view folder_of(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  return slash == path.npos ? std::string_view{} : path.substr(0, slash);
}

}  // namespace kerf::arch
