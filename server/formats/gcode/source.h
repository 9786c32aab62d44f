// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// Most files that a program may call subroutines from, and most bytes that they may hold together.
inline constexpr std::size_t kGcodeFilesMax = 1000;
inline constexpr std::size_t kGcodeFilesBytesMax = std::size_t{256} << 20;

/// A text of G-code as lines, and which of them may begin with an O word.
struct GcodeFile {
  std::string name;  ///< as errors tell it
  std::string text;
  std::vector<std::string_view> lines;    ///< of `text`
  std::vector<std::size_t> o_word_lines;  ///< indices into `lines`, ascending

  GcodeFile(std::string file_name, std::string file_text);
  GcodeFile(const GcodeFile&) = delete;
  GcodeFile& operator=(const GcodeFile&) = delete;
};

/// The program's text, and the files of its subroutines, which are read when they are called first.
/// Throws GcodeFault.
class GcodeSource {
 public:
  /// "name.ngc" is looked for in `folders`, in order; without any, no file is read.
  GcodeSource(std::string name, std::string_view text, std::vector<std::filesystem::path> folders);

  const GcodeFile& file(std::size_t index) const { return *files_[index]; }
  std::size_t size() const { return files_.size(); }
  /// The index of the file of a subroutine; 0, the program itself, where there is none.
  std::size_t find(const std::string& subroutine);

 private:
  std::vector<std::filesystem::path> folders_;
  std::vector<std::unique_ptr<GcodeFile>> files_;
  std::map<std::string, std::size_t> found_;
  std::size_t bytes_ = 0;
};

}  // namespace kerf
