// SPDX-License-Identifier: Apache-2.0
#include "server/store/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace kerf {
namespace {

/// Returns the process named in the lock file; empty if there is none yet.
std::string holder(int file) {
  std::array<char, 16> text{};
  const ssize_t size = pread(file, text.data(), text.size(), 0);
  std::string name(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  return name.substr(0, name.find('\n'));
}

/// Returns why the process cannot create files in the folder; empty if it can.
std::string write_error(const std::filesystem::path& folder) {
  if (faccessat(AT_FDCWD, folder.c_str(), R_OK | W_OK | X_OK, AT_EACCESS) == 0) return {};
  const std::string reason = std::strerror(errno);
  struct stat status = {};
  const std::string owner = stat(folder.c_str(), &status) == 0
                                ? ", which belongs to uid " + std::to_string(status.st_uid)
                                : std::string();
  const std::string uid = std::to_string(geteuid());
  return "uid " + uid + " cannot write to the data folder " + folder.string() + owner + ": " +
         reason + "; make uid " + uid + " its owner, or use another --data";
}

}  // namespace

std::expected<FolderLock, std::string> FolderLock::take(const std::filesystem::path& folder) {
  if (std::string error = write_error(folder); !error.empty()) return std::unexpected(error);
  const auto path = folder / kFileName;
  FolderLock lock(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (lock.file_ < 0) {
    return std::unexpected("cannot open " + path.string() + ": " + std::strerror(errno));
  }
  if (flock(lock.file_, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) {
      return std::unexpected("cannot lock " + path.string() + ": " + std::strerror(errno));
    }
    const std::string process = holder(lock.file_);
    return std::unexpected(
        "the data folder " + folder.string() + " is in use by another kerf-server" +
        (process.empty() ? "" : ", process " + process) + ": stop it or use another --data");
  }
  // The number is only used in the error of a second server, so failing to write it, e.g. on a full
  // disk, does not prevent the start.
  const std::string text = std::to_string(getpid()) + "\n";
  if (ftruncate(lock.file_, 0) == 0) (void)!pwrite(lock.file_, text.data(), text.size(), 0);
  return lock;
}

FolderLock::FolderLock(FolderLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
FolderLock& FolderLock::operator=(FolderLock&& other) noexcept {
  std::swap(file_, other.file_);
  return *this;
}
FolderLock::~FolderLock() {
  if (file_ >= 0) close(file_);
}

}  // namespace kerf
