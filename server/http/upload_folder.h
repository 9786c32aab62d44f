// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

namespace kerf::net {

struct UploadLimits {
  std::size_t files_of_owner = 16;
  std::size_t files = 1024;                        ///< of all owners
  std::uintmax_t bytes = std::uintmax_t{1} << 30;  ///< of all owners
};

/// Keeps uploaded meshes until scenes name them: a session has its own copy in its journal. Each
/// owner has a folder with its newest files. Where all files together exceed a limit, the owner
/// with the most bytes, or files, loses its oldest one: uploads of one owner never delete those of
/// another who keeps less. Thread-safe.
class UploadFolder {
 public:
  explicit UploadFolder(std::filesystem::path folder, UploadLimits limits = {})
      : folder_(std::move(folder)), limits_(limits) {}

  /// Stores a file. `owner` tells clients apart; `extension` begins with a dot and is part of a
  /// file name. Returns the name that scenes use, a hash of the contents: equal files have equal
  /// names. Empty if the file could not be written. The file outlasts the call whatever the limits.
  std::string keep(const std::string& owner, const std::string& extension,
                   const std::string& bytes);
  /// Returns the contents of the files whose names stand in a text, in quotes, by name.
  std::map<std::string, std::string> named_in(std::string_view text) const;

 private:
  /// Deletes what exceeds the limits, but never the file that was just stored.
  void delete_beyond_limits(const std::filesystem::path& stored);

  std::filesystem::path folder_;
  UploadLimits limits_;
  mutable std::mutex mutex_;  ///< of those that store, delete and list
};

}  // namespace kerf::net
