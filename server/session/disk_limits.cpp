// SPDX-License-Identifier: Apache-2.0
#include "server/session/disk_limits.h"

#include <ftw.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <system_error>

#include "server/store/block_snapshot.h"

namespace kerf {
namespace {

constexpr double kLowShare = 0.9;

std::uintmax_t size_of(const std::filesystem::path& file) {
  std::error_code absent;
  const auto size = std::filesystem::file_size(file, absent);
  return absent ? 0 : size;
}

/// "12.3 MB".
std::string megabytes(std::uintmax_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f MB", static_cast<double>(bytes) / 1e6);
  return text;
}

// libstdc++'s recursive_directory_iterator ends the program if it lacks memory.
thread_local std::uintmax_t regular_bytes;
/// Adds the size of a file to `regular_bytes`. Files may appear and disappear during the walk.
int add_regular(const char*, const struct stat* status, int type, FTW*) {
  if (type == FTW_F && S_ISREG(status->st_mode)) {
    regular_bytes += static_cast<std::uintmax_t>(status->st_size);
  }
  return 0;
}

}  // namespace

DiskUse measure_disk(const std::filesystem::path& folder) {
  DiskUse use;
  constexpr int kOpenFolders = 16;
  regular_bytes = 0;
  nftw(folder.c_str(), &add_regular, kOpenFolders, FTW_PHYS);
  use.folder = regular_bytes;
  std::error_code error;
  const auto space = std::filesystem::space(folder, error);
  const bool is_known = !error && space.capacity > 0;  // some file systems report nothing
  use.free = is_known ? space.available : std::numeric_limits<std::uintmax_t>::max();
  return use;
}

std::uintmax_t session_bytes(const std::filesystem::path& journal) {
  std::uintmax_t bytes = size_of(snapshot_file(journal)) + size_of(previous_snapshot_file(journal));
  for (const char* suffix : {"", "-wal", "-shm"}) bytes += size_of(journal.string() + suffix);
  return bytes;
}

DiskLevel disk_level(double share, DiskLevel before) {
  if (share >= 1) return DiskLevel::kFull;
  if (share < kLowShare) return DiskLevel::kFine;
  return before == DiskLevel::kFull ? DiskLevel::kFull : DiskLevel::kLow;
}

double share_of(std::uintmax_t bytes, std::uintmax_t limit) {
  return limit == 0 ? 0 : static_cast<double>(bytes) / static_cast<double>(limit);
}

double shared_share(const DiskUse& use, const DiskLimits& limits) {
  const auto free = std::max<std::uintmax_t>(use.free, 1);
  const double reserve = static_cast<double>(limits.reserve) / static_cast<double>(free);
  return std::max(share_of(use.folder, limits.folder), reserve);
}

std::string session_full(std::uintmax_t bytes, const DiskLimits& limits) {
  return "the session's files have " + megabytes(bytes) + " of the " + megabytes(limits.session) +
         " that --disk-per-session allows: raise it, or close the session and start another";
}

std::optional<std::string> needed_for_sessions(const DiskUse& use, const DiskLimits& limits) {
  if (use.free / 2 >= limits.reserve) return std::nullopt;
  return "the file system of the data folder has " + megabytes(use.free) +
         " left, and downloads leave " + megabytes(2 * limits.reserve) +
         " to the sessions, twice --disk-reserve: make space";
}

std::string folder_full(const DiskUse& use, const DiskLimits& limits) {
  if (share_of(use.folder, limits.folder) < shared_share(use, limits)) {
    return "the file system of the data folder has " + megabytes(use.free) +
           " left, and --disk-reserve keeps " + megabytes(limits.reserve) + " free: make space";
  }
  return "the data folder has " + megabytes(use.folder) + " of the " + megabytes(limits.folder) +
         " that --disk-total allows: raise it, or delete closed sessions";
}

}  // namespace kerf
