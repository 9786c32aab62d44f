// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace kerf {

/// Disk space that the sessions of a server may use, bytes. 0 means no limit.
struct DiskLimits {
  std::uintmax_t session = 0;  ///< journal, its side files and snapshot of one session
  std::uintmax_t folder = 0;   ///< all files of the data folder, closed sessions included
  std::uintmax_t reserve = 0;  ///< minimum free space on the file system
};

/// Size of the data folder and free space of its file system, bytes.
struct DiskUse {
  std::uintmax_t folder = 0, free = 0;
};

/// Sums up the files of a folder and its subfolders. Unreadable files count as 0. If the file
/// system does not report its free space, it counts as unlimited.
DiskUse measure_disk(const std::filesystem::path& folder);

/// Size of a journal, its side files and its snapshot, bytes.
std::uintmax_t session_bytes(const std::filesystem::path& journal);

/// How close the files are to a limit. kFull: nothing may be added. kLow, from nine tenths of the
/// limit: no snapshots are written, because a session can do without them.
enum class DiskLevel { kFine, kLow, kFull };

/// Returns the level for `share`, the used fraction of a limit. kFull persists until the level
/// would be kFine: without this hysteresis, a session would pause and continue with every record.
DiskLevel disk_level(double share, DiskLevel before);

/// Returns the fraction of a limit that `bytes` use; 0 without a limit.
double share_of(std::uintmax_t bytes, std::uintmax_t limit);

/// Returns the used fraction of the limits shared by all sessions: folder or reserve, the greater.
double shared_share(const DiskUse& use, const DiskLimits& limits);

/// Returns one sentence if dispensable files may take no space: free space is below twice the
/// reserve (sessions pause below the reserve itself). Nullopt if there is enough.
std::optional<std::string> needed_for_sessions(const DiskUse& use, const DiskLimits& limits);

/// Return one sentence: which limit is exceeded, by how much, and the remedy.
std::string session_full(std::uintmax_t bytes, const DiskLimits& limits);
std::string folder_full(const DiskUse& use, const DiskLimits& limits);

}  // namespace kerf
