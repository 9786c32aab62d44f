// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

namespace kerf::test {

/// The behavior of a failing disk.
enum class DiskFault {
  kNone,
  kNoSpace,     ///< a write stores as much as fits, then the disk is full
  kIoError,     ///< a write stores nothing and fails
  kShortWrite,  ///< a write stores half of its bytes and fails
  kSyncFails    ///< fsync fails
};
/// The files that a fault affects.
enum class FaultTarget { kAll, kLog, kDatabase };

/// Makes the disk fail after `after_bytes` more bytes have been written to the target.
struct FaultRule {
  DiskFault fault = DiskFault::kNone;
  FaultTarget target = FaultTarget::kAll;
  std::uint64_t after_bytes = 0;
};

/// While it exists, the default file system of SQLite: forwards all calls to the former default and
/// fails by rule. At most one may exist. Close every database before destroying it. Functions may
/// be called from any thread.
class FaultyDisk {
 public:
  FaultyDisk();
  ~FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;

  /// Replaces the rule and counts bytes from zero.
  void fail(const FaultRule& rule);
  void heal() { fail({}); }
  /// Makes every fsync take this long.
  void set_sync_time(std::chrono::microseconds time);
  /// While set, an fsync does not return.
  void block_syncs(bool block);
  /// Runs `work` while no write is in progress: the files are in the state that a crash would
  /// leave.
  void hold(const std::function<void()>& work);

  /// Bytes written to databases and their logs.
  std::uint64_t bytes_written() const;
  /// Bytes read from databases and their logs.
  std::uint64_t bytes_read() const;
  /// Calls that failed by rule.
  std::uint64_t failures() const;
};

}  // namespace kerf::test
