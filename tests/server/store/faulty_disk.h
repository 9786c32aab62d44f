// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

namespace kerf::test {

/// How a disk fails.
enum class DiskFault {
  kNone,
  kNoSpace,     ///< a write stores what fits, then the disk is full
  kIoError,     ///< a write stores nothing and fails
  kShortWrite,  ///< a write stores half of its bytes and fails
  kSyncFails    ///< fsync fails
};
/// The files that a fault affects.
enum class FaultTarget { kAll, kLog, kDatabase };

/// When and where a disk fails: after `after_bytes` further bytes have been written to the target.
struct FaultRule {
  DiskFault fault = DiskFault::kNone;
  FaultTarget target = FaultTarget::kAll;
  std::uint64_t after_bytes = 0;
};

/// The default file system of SQLite while it exists: passes all calls on to the former default and
/// fails by rule. At most one may exist; every database must be closed before it is destroyed.
/// Functions may be called from any thread.
class FaultyDisk {
 public:
  FaultyDisk();
  ~FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;

  /// Replaces the rule and counts bytes from zero.
  void fail(const FaultRule& rule);
  void heal() { fail({}); }
  /// Every fsync takes this long.
  void set_sync_time(std::chrono::microseconds time);
  /// While set, an fsync does not return.
  void block_syncs(bool block);
  /// Runs `work` while no write is in progress: the files are as a crash would leave them.
  void hold(const std::function<void()>& work);

  /// Bytes written to databases and their logs.
  std::uint64_t bytes_written() const;
  /// Bytes read from databases and their logs.
  std::uint64_t bytes_read() const;
  /// Calls that failed by rule.
  std::uint64_t failures() const;
};

}  // namespace kerf::test
