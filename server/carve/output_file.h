// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <string>

namespace kerf {

/// A file that is complete or absent: it is written under a temporary name in the same folder and
/// renamed by commit(). Without commit() it is removed.
class OutputFile {
 public:
  /// If `target` is not a regular file (/dev/stdout, a pipe), commit() copies into it.
  explicit OutputFile(std::filesystem::path target);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  /// The path to write to.
  const std::filesystem::path& temporary() const { return temporary_; }
  const std::filesystem::path& target() const { return target_; }
  std::expected<void, std::string> commit();

 private:
  std::filesystem::path target_, temporary_;
  bool copy_ = false;
};

}  // namespace kerf
