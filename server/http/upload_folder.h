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

/// Keeps uploaded meshes until scenes name them; a session then has its own copy in its journal.
/// Each owner has a folder with its newest files. When all files together exceed a limit, the owner
/// with the most bytes (or files) loses its oldest one, so an upload never deletes a file of
/// another owner that stores less. Thread-safe.
class UploadFolder {
 public:
  explicit UploadFolder(std::filesystem::path folder, UploadLimits limits = {})
      : folder_(std::move(folder)), limits_(limits) {}

  /// Stores a file. `owner` distinguishes clients. `extension` begins with a dot and becomes part
  /// of the file name. Returns the name for use in scenes, a hash of the contents; empty if the
  /// file could not be written. The limits never delete this file during the call.
  std::string keep(const std::string& owner, const std::string& extension,
                   const std::string& bytes);
  /// Returns the contents of the files whose quoted names are in a text, by name.
  std::map<std::string, std::string> named_in(std::string_view text) const;

 private:
  /// Deletes files beyond the limits, but never the one just stored.
  void delete_beyond_limits(const std::filesystem::path& stored);

  std::filesystem::path folder_;
  UploadLimits limits_;
  mutable std::mutex mutex_;  ///< serializes storing, deleting and listing
};

}  // namespace kerf::net
