// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace kerf {

/// A file that is complete or absent: written under a temporary name in the same folder and renamed
/// by commit(). Without commit() it is removed.
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

/// The output files of a run. Thread-safe.
class OutputFiles {
 public:
  /// Adds a file. The reference is valid as long as this object.
  OutputFile& add(const std::filesystem::path& target);
  /// Commits all files in the order of add(). The error is that of the first failure. That file and
  /// all after it are not written.
  std::expected<void, std::string> commit();
  /// Removes the temporary files, even while they are being written, because the process is about
  /// to end.
  void abandon();

 private:
  std::mutex mutex_;  ///< guards files_, not their content
  std::vector<std::unique_ptr<OutputFile>> files_;
};

}  // namespace kerf
