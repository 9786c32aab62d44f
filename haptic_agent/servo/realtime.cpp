// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstddef>
#include <string_view>
#include <system_error>

#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {
namespace {

/// More than a tick needs; the first touch of a page must not happen in the loop.
constexpr std::size_t kStackBytes = 128 * 1024;
constexpr std::size_t kPageBytes = 4096;

void touch_stack() noexcept {
  std::byte stack[kStackBytes];
  volatile std::byte* const pages = stack;
  for (std::size_t at = 0; at < kStackBytes; at += kPageBytes) pages[at] = std::byte{1};
}

bool pin(int cpu) noexcept {
  cpu_set_t only;
  CPU_ZERO(&only);
  if (cpu >= CPU_SETSIZE) return false;
  CPU_SET(static_cast<std::size_t>(cpu), &only);
  return pthread_setaffinity_np(pthread_self(), sizeof only, &only) == 0;
}

void warn(RealtimeReport& report, std::string_view text) {
  if (!report.warning.empty()) report.warning += "; ";
  report.warning += text;
}

}  // namespace

int request_fifo(int priority) noexcept {
  const sched_param wanted{.sched_priority = priority};
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted);
}

RealtimeReport make_realtime(const RealtimeWish& wish) {
  RealtimeReport report;
  if (const int failed = request_fifo(wish.priority); failed == 0) {
    report.fifo = true;
  } else {
    warn(report, join({"no real-time priority (", std::generic_category().message(failed),
                       "): the 1 kHz loop runs as an ordinary thread; allow it with rtprio in "
                       "limits.conf or CAP_SYS_NICE"}));
  }
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
    report.memory_locked = true;
  } else {
    warn(report, join({"memory is not locked (", std::generic_category().message(errno), ")"}));
  }
  if (wish.cpu >= 0) {
    report.pinned = pin(wish.cpu);
    if (!report.pinned) {
      warn(report, join({"the loop cannot stay on processor ", std::to_string(wish.cpu)}));
    }
  }
  touch_stack();
  return report;
}

}  // namespace kerf::agent
