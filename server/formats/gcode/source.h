// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/gcode/line_index.h"
#include "server/formats/gcode/macro_index.h"

namespace kerf {

/// Most files of a program, its own included, and most bytes of its subroutine files together.
inline constexpr std::size_t kGcodeFilesMax = 1000;
inline constexpr std::size_t kGcodeFilesBytesMax = std::size_t{256} << 20;

/// A G-code text divided into lines, with an index of the lines that may begin with an O word.
struct GcodeFile {
  std::string name;  ///< file name in errors
  LineIndex lines;
  std::vector<std::uint32_t> o_word_lines;  ///< indices into `lines`, ascending

  /// `file_text` must outlive it.
  GcodeFile(std::string file_name, std::string_view file_text);
  GcodeFile(const GcodeFile&) = delete;
  GcodeFile& operator=(const GcodeFile&) = delete;

  /// The marks of Macro B, found at the first call.
  const MacroIndex& marks() const;

 private:
  mutable std::optional<MacroIndex> marks_;
};

/// The text of a program and of its subroutine files, which are read on the first call. Throws
/// ProgramFault.
class GcodeSource {
 public:
  /// `text` must outlive it. `folders` are searched, in order, for the subroutine files: a name
  /// with one of `extensions`.
  GcodeSource(std::string name, std::string_view text, std::vector<std::filesystem::path> folders,
              std::vector<std::string> extensions = {".ngc"});

  const GcodeFile& file(std::size_t index) const { return *files_[index]; }
  std::size_t size() const { return files_.size(); }
  /// The names of all files.
  std::vector<std::string> names() const;
  /// Returns the index of the file of a subroutine, reading it if necessary, or 0, the program
  /// itself, if there is no such file.
  std::size_t find(const std::string& subroutine);

 private:
  std::vector<std::filesystem::path> folders_;
  std::vector<std::string> extensions_;
  std::vector<std::unique_ptr<GcodeFile>> files_;
  std::deque<std::string> texts_;  ///< of the subroutine files
  std::map<std::string, std::size_t> found_;
  std::size_t bytes_ = 0;
};

}  // namespace kerf
