// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <string>

namespace kerf {

/// A file that appears under its name only when everything has succeeded: it is written beside it
/// under a temporary name; commit() renames it, and without commit() nothing is left behind.
class OutputFile {
 public:
  /// `target` may also be something that is no plain file (/dev/stdout, a pipe): commit() then
  /// copies into it.
  explicit OutputFile(std::filesystem::path target);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  /// Where to write.
  const std::filesystem::path& temporary() const { return temporary_; }
  const std::filesystem::path& target() const { return target_; }
  std::expected<void, std::string> commit();

 private:
  std::filesystem::path target_, temporary_;
  bool copy_ = false;
};

}  // namespace kerf
