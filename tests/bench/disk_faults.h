// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf::bench {

/// What disk_faults.cpp lets a disk do.
enum class DiskFault : std::uint32_t {
  kNone,
  kFull,        ///< writes fail with ENOSPC
  kWriteFails,  ///< writes fail with EIO
  kWritesHalf,  ///< a write stores half of what is left, at last nothing
  kSyncFails    ///< fsync fails with EIO; the writes are done
};

/// What the soak and the server share.
struct DiskControl {
  DiskFault fault;             ///< that is wanted now
  std::uint32_t failed_calls;  ///< since the start
};

}  // namespace kerf::bench
