// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

namespace kerf::agent {

/// Event counters of a port. Incremented by the event thread, readable from any thread.
struct UsbCounters {
  using Count = std::atomic<std::uint64_t>;
  Count reports{0};
  /// Rejected reports: too short, wrong checksum, values out of range.
  Count bad_reports{0};
  Count empty_packets{0};
  Count stalls{0};
  Count overflows{0};
  Count timeouts{0};
  Count errors{0};
  Count sent{0};
  /// Wrenches replaced by a newer one while a packet was in flight.
  Count skipped{0};
  Count connections{0};
  Count losses{0};
};

}  // namespace kerf::agent
