// SPDX-License-Identifier: Apache-2.0
#include "tests/arch/modules.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>

namespace kerf::arch {
namespace {

using Texts = std::map<std::string, std::string, std::less<>>;

bool is_word_char(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' || c == '/';
}

bool has_word(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_word_char(text[at - 1])) &&
        (end == text.size() || !is_word_char(text[end])))
      return true;
  }
  return false;
}

// Returns true if the CMakeLists.txt of the file's folder, or of one above it, names the file
// relative to that folder.
bool is_built(const Texts& texts, std::string_view path) {
  for (std::string_view folder = folder_of(path);; folder = folder_of(folder)) {
    const std::string list = std::string(folder) + (folder.empty() ? "" : "/") + "CMakeLists.txt";
    const auto found = texts.find(list);
    const std::string_view name = folder.empty() ? path : path.substr(folder.size() + 1);
    if (found != texts.end() && has_word(found->second, name)) return true;
    if (folder.empty()) return false;
  }
}

bool is_described(const Texts& texts, std::string_view folder) {
  for (; !folder.empty(); folder = folder_of(folder)) {
    if (texts.contains(std::string(folder) + "/README.md")) return true;
  }
  return false;
}

// Returns the module of a header: the first two folders of its path, or the first one.
std::string module_of(std::string_view path) {
  const std::size_t first = path.find('/'), second = path.find('/', first + 1);
  return std::string(path.substr(0, second == path.npos ? first : second));
}

void check_tests(const std::vector<Source>& tree, std::vector<Violation>& violations) {
  std::set<std::string> modules, tested;
  for (const Source& source : tree) {
    const bool test = source.path.starts_with("tests/");
    if (!test && is_header(source.path)) modules.insert(module_of(source.path));
    if (!test || !is_cpp(source.path)) continue;
    for (std::string_view line : lines_of(source.text)) {
      if (!line.starts_with("#include \"")) continue;
      tested.insert(module_of(line.substr(10, line.find('"', 10) - 10)));
    }
  }
  for (const std::string& module : modules) {
    if (!tested.contains(module))
      violations.push_back({module, 0, "no test includes any of its headers"});
  }
}

// Sources and scripts state their license in the first or second line.
void check_license(const Source& source, std::vector<Violation>& violations) {
  static const std::set<std::string> kSuffixes = {".h",   ".cpp", ".ts", ".tsx",
                                                  ".mjs", ".py",  ".sh", ".css"};
  const std::string suffix = std::filesystem::path(source.path).extension().string();
  if (!kSuffixes.contains(suffix)) return;
  constexpr std::string_view kLine = "SPDX-License-Identifier: Apache-2.0";
  if (std::string_view(source.text).substr(0, 120).find(kLine) != std::string_view::npos) return;
  violations.push_back({source.path, 1, "the file has no SPDX line"});
}

// A link from one README to another is relative to the folder of the README that contains it.
void check_links(const Texts& texts, std::vector<Violation>& violations) {
  static const std::regex kLink(R"(\]\(((?:\.\./)*[A-Za-z_][A-Za-z0-9_/.-]*\.(?:md|svg))\))");
  for (const auto& [path, text] : texts) {
    if (!path.ends_with(".md")) continue;
    const std::string folder(folder_of(path));
    for (std::sregex_iterator it(text.begin(), text.end(), kLink), end; it != end; ++it) {
      const std::string target =
          (std::filesystem::path(folder) / it->str(1)).lexically_normal().generic_string();
      if (texts.contains(target)) continue;
      violations.push_back({path, line_at(text, static_cast<std::size_t>(it->position())),
                            "broken link: " + target});
    }
  }
}

}  // namespace

std::vector<Violation> check_modules(const std::vector<Source>& tree) {
  static const std::set<std::string_view> kTop = {"server", "kernel", "haptic_agent", "web",
                                                  "tests",  "docker", ".ci"};
  Texts texts;
  for (const Source& source : tree) texts.emplace(source.path, source.text);
  std::vector<Violation> violations;
  std::set<std::string_view> folders;
  for (const Source& source : tree) {
    if (source.path.ends_with(".cpp") && !is_built(texts, source.path)) {
      violations.push_back({source.path, 0, "no CMakeLists.txt builds this file"});
    }
    check_license(source, violations);
    if (is_cpp(source.path) || is_typescript(source.path)) folders.insert(folder_of(source.path));
    const std::string_view top = std::string_view(source.path).substr(0, source.path.find('/'));
    if (source.path.find('/') != source.path.npos && !kTop.contains(top)) {
      violations.push_back(
          {source.path, 0, "the top level is fixed and does not include this folder"});
    }
  }
  for (std::string_view folder : folders) {
    if (!is_described(texts, folder)) {
      violations.push_back(
          {std::string(folder), 0, "no README.md in this folder or above it describes it"});
    }
  }
  check_links(texts, violations);
  check_tests(tree, violations);
  return violations;
}

}  // namespace kerf::arch
