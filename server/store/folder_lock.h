// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <string>

namespace kerf {

/// The lock of a data folder, held by one process at a time. Without it, two servers on one folder
/// would both append to its journals. The operating system releases it however the process ends.
/// The lock file, which names the process, remains.
class FolderLock {
 public:
  /// Name of the lock file in the folder.
  static constexpr const char* kFileName = "kerf-server.lock";

  /// Locks `folder`, in which the process must be able to create files. The error is one sentence
  /// that names the process holding the lock or the owner of an unwritable folder.
  static std::expected<FolderLock, std::string> take(const std::filesystem::path& folder);
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&& other) noexcept;
  ~FolderLock();

 private:
  explicit FolderLock(int file) : file_(file) {}
  int file_ = -1;
};

}  // namespace kerf
