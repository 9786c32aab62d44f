// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/sim/os/scheduler.h"

namespace kerf::sim {

/// Whether writes and synchronization succeed.
enum class DiskState : std::uint8_t {
  kFine,
  kFull,    ///< a write stores at most `free_bytes`; then it fails with ENOSPC
  kFails,   ///< writes fail
  kNoSync,  ///< writes succeed, and synchronizing fails
};

/// The disk of a machine: a folder of the real file system. Writes to files below it fail by its
/// state, and synchronization takes time. It remembers writes that have not been synchronized: a
/// loss of power takes them back.
class Disk {
 public:
  /// The folder exists. While the disk exists, calls for files below the folder come to it.
  explicit Disk(std::filesystem::path folder);
  ~Disk();
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  /// Copies the files as they are, as for a machine on which a process was killed.
  void copy_to(const std::filesystem::path& folder) const;
  /// Copies the files as they are after a loss of power: of the writes that were not synchronized
  /// each is there, is not, or is torn at a sector.
  void copy_after_power_loss(const std::filesystem::path& folder) const;

  DiskState state = DiskState::kFine;
  std::uint64_t free_bytes = 0;     ///< kFull
  Time sync_ns = kMillisecond / 2;  ///< the longest time to synchronize a file

  // ---- for the calls of the C library (disk_calls.cpp) ----
  /// The disk of a file that is open for writing; null: it is on none.
  static Disk* of(int file);
  /// As write(2) at `offset`, which `real` carries out.
  std::int64_t write(int file, const void* bytes, std::size_t size, std::int64_t offset,
                     std::int64_t (*real)(int, const void*, std::size_t, std::int64_t));
  int truncate(int file, std::int64_t size, int (*real)(int, std::int64_t));
  int synchronize(int file);

 private:
  struct Change {
    std::int64_t offset = 0;
    std::vector<char> before, after;  ///< `before` ends where the file did
    bool is_truncation = false;       ///< to `offset`; `before` is what stood behind
  };
  /// The unsynchronized changes of a file. The open descriptor `holder` (O_PATH) keeps the file
  /// system from reusing its inode number after the file is deleted.
  struct Unsynced {
    Unsynced() = default;
    ~Unsynced();
    Unsynced(const Unsynced&) = delete;
    Unsynced& operator=(const Unsynced&) = delete;
    int holder = -1;
    std::vector<Change> changes;
  };
  void remember(int file, Change change);
  static void take_back(const std::filesystem::path& file, const std::vector<Change>& changes);

  std::filesystem::path folder_;
  std::map<std::uint64_t, Unsynced> unsynced_;  ///< by inode
};

}  // namespace kerf::sim
