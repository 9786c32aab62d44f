// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/realtime/realtime_thread.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstddef>
#include <initializer_list>
#include <string_view>
#include <system_error>

namespace kerf::agent {
namespace {

/// More than a tick needs. The stack is touched in advance, so that the loop takes no page faults.
constexpr std::size_t kStackBytes = std::size_t{128} * 1024;
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

void warn(RealtimeReport& report, std::initializer_list<std::string_view> parts) {
  if (!report.warning.empty()) report.warning += "; ";
  for (const std::string_view part : parts) report.warning += part;
}

}  // namespace

int limit_thread_stacks() noexcept {
  pthread_attr_t attributes;
  if (const int failed = pthread_getattr_default_np(&attributes); failed != 0) return failed;
  int failed = pthread_attr_setstacksize(&attributes, kThreadStackBytes);
  if (failed == 0) failed = pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
  return failed;
}

int request_fifo(int priority) noexcept {
  const sched_param parameter{.sched_priority = priority};
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
}

RealtimeReport make_realtime(const RealtimeRequest& request) {
  RealtimeReport report;
  if (const int failed = request_fifo(request.priority); failed == 0) {
    report.fifo = true;
  } else {
    warn(report, {"no real-time priority (", std::generic_category().message(failed),
                  "): the 1 kHz loop runs as an ordinary thread; grant rtprio in limits.conf or "
                  "CAP_SYS_NICE"});
  }
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
    report.memory_locked = true;
  } else {
    warn(report, {"memory is not locked (", std::generic_category().message(errno), ")"});
  }
  if (request.cpu >= 0) {
    report.pinned = pin(request.cpu);
    if (!report.pinned) {
      warn(report, {"the loop cannot be pinned to processor ", std::to_string(request.cpu)});
    }
  }
  touch_stack();
  return report;
}

}  // namespace kerf::agent
