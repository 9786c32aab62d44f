// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

namespace kerf::agent {

/// What a port has seen since it was made. The event thread counts, anybody may look.
struct UsbCounters {
  using Count = std::atomic<std::uint64_t>;
  Count reports{0};
  /// Understood by nobody: too short, a wrong sum, a number out of range.
  Count bad_reports{0};
  Count empty_packets{0};
  Count stalls{0};
  Count overflows{0};
  Count timeouts{0};
  Count errors{0};
  Count sent{0};
  /// A new wrench came while the last one was still on its way; the newest goes out after it.
  Count skipped{0};
  Count connections{0};
  Count losses{0};
};

}  // namespace kerf::agent
