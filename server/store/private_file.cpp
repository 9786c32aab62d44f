// SPDX-License-Identifier: Apache-2.0
#include "server/store/private_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace kerf {
namespace {

constexpr mode_t kFileMode = 0600;
constexpr mode_t kFolderMode = 0700;

std::error_code last_error() { return {errno, std::generic_category()}; }

}  // namespace

std::error_code create_private_file(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kFileMode);
  if (descriptor < 0) return last_error();
  close(descriptor);
  return {};
}

std::error_code create_private_folder(const std::filesystem::path& folder) {
  std::error_code unknown;
  if (folder.empty() || std::filesystem::is_directory(folder, unknown)) return {};
  if (!folder.has_filename()) return create_private_folder(folder.parent_path());  // "NAME/"
  if (const auto error = create_private_folder(folder.parent_path())) return error;
  if (mkdir(folder.c_str(), kFolderMode) == 0 || errno == EEXIST) return {};
  return last_error();
}

}  // namespace kerf
