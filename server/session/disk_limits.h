// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace kerf {

/// How much of the disk the sessions of a server may use, bytes; 0: no limit.
struct DiskLimits {
  std::uintmax_t session = 0;  ///< journal, its side files and snapshot of one session
  std::uintmax_t folder = 0;   ///< all files of the data folder, closed sessions included
  std::uintmax_t reserve = 0;  ///< stays free on the file system
};

/// What the data folder takes, and what is left on its file system; bytes.
struct DiskUse {
  std::uintmax_t folder = 0, free = 0;
};

/// Adds up the files of a folder and of those in it. What cannot be read counts as nothing; a file
/// system that does not say what is free has no end.
DiskUse measure_disk(const std::filesystem::path& folder);

/// Size of a journal, its side files and its snapshot, bytes.
std::uintmax_t session_bytes(const std::filesystem::path& journal);

/// How close to a limit the files are. Full: nothing may be added. Low, from nine tenths of the
/// limit on: no snapshots, which a session can do without.
enum class DiskLevel { kFine, kLow, kFull };

/// The level of the use `share` of a limit, 1 being all of it. What was full stays so until it is
/// not even low, so that a session does not stop and go on with every record.
DiskLevel disk_level(double share, DiskLevel before);

/// The part of a limit that `bytes` are; 0 without a limit.
double share_of(std::uintmax_t bytes, std::uintmax_t limit);

/// The part of the limits of all sessions that is used: of the folder or the reserve, the greater.
double shared_share(const DiskUse& use, const DiskLimits& limits);

/// Why nothing that sessions can do without may take space, as one sentence: less is free than
/// twice the reserve, below which they are paused. Nothing: there is enough.
std::optional<std::string> needed_for_sessions(const DiskUse& use, const DiskLimits& limits);

/// One sentence that says which limit is reached, by how much, and what to do.
std::string session_full(std::uintmax_t bytes, const DiskLimits& limits);
std::string folder_full(const DiskUse& use, const DiskLimits& limits);

}  // namespace kerf
