// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf::bench {

/// Faults that disk_faults.cpp simulates.
enum class DiskFault : std::uint32_t {
  kNone,
  kFull,        ///< writes fail with ENOSPC
  kWriteFails,  ///< writes fail with EIO
  kWritesHalf,  ///< a write stores half of its bytes, in the end none
  kSyncFails    ///< fsync fails with EIO; the writes are done
};

/// Memory shared by the soak and the server.
struct DiskControl {
  DiskFault fault;             ///< requested now
  std::uint32_t failed_calls;  ///< since the start
};

}  // namespace kerf::bench
