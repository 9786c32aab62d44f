// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/source.h"

#include <cctype>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/letter_case.h"
#include "server/formats/text_file.h"

namespace kerf {
namespace {

// Whether a line, after blanks and a line number, continues with O, with the M of M98 and M99, or
// with a comment, which may precede either.
bool may_hold_o_word(std::string_view line) {
  std::size_t at = 0;
  const auto blanks = [&] {
    while (at < line.size() && std::isspace(static_cast<unsigned char>(line[at])) != 0) ++at;
  };
  const auto is = [&](char small) { return at < line.size() && to_lower(line[at]) == small; };
  blanks();
  if (is('n')) {
    ++at;
    blanks();
    while (at < line.size() && (std::isdigit(static_cast<unsigned char>(line[at])) != 0 ||
                                line[at] == '.' || line[at] == ' ' || line[at] == '\t'))
      ++at;
  }
  return is('o') || is('m') || is('(');
}

}  // namespace

GcodeFile::GcodeFile(std::string file_name, std::string_view file_text)
    : name(std::move(file_name)), lines(file_text) {
  for (std::size_t n = 0; n < lines.size(); ++n) {
    if (may_hold_o_word(lines[n])) o_word_lines.push_back(static_cast<std::uint32_t>(n));
  }
}

const MacroIndex& GcodeFile::marks() const {
  if (!marks_) marks_.emplace(lines);
  return *marks_;
}

GcodeSource::GcodeSource(std::string name, std::string_view text,
                         std::vector<std::filesystem::path> folders,
                         std::vector<std::string> extensions)
    : folders_(std::move(folders)), extensions_(std::move(extensions)) {
  files_.push_back(std::make_unique<GcodeFile>(std::move(name), text));
}

std::vector<std::string> GcodeSource::names() const {
  std::vector<std::string> names;
  for (const auto& file : files_) names.push_back(file->name);
  return names;
}

std::size_t GcodeSource::find(const std::string& subroutine) {
  if (const auto it = found_.find(subroutine); it != found_.end()) return it->second;
  // A name must not lead out of the folders.
  if (subroutine.find_first_of("/\\") != std::string::npos || subroutine.starts_with("."))
    throw ProgramFault{
        "O<" + subroutine + ">",
        "is not allowed as the name of a subroutine file; it must not begin with '.' "
        "or contain / or \\"};
  for (const std::filesystem::path& folder : folders_) {
    std::error_code error;
    std::filesystem::path path;
    for (const std::string& extension : extensions_) {
      path = folder / (subroutine + extension);
      if (std::filesystem::is_regular_file(path, error)) break;
      path.clear();
    }
    if (path.empty()) continue;
    const auto size = std::filesystem::file_size(path, error);
    if (files_.size() >= kGcodeFilesMax || error || bytes_ + size > kGcodeFilesBytesMax)
      throw ProgramFault{"O<" + subroutine + ">",
                         "exceeds the limit of 1000 files and 256 MiB of subroutine files"};
    auto text = read_file(path);
    if (!text) continue;
    bytes_ += text->size();
    found_[subroutine] = files_.size();
    texts_.push_back(*std::move(text));
    files_.push_back(std::make_unique<GcodeFile>(path.string(), texts_.back()));
    return files_.size() - 1;
  }
  return 0;
}

}  // namespace kerf
