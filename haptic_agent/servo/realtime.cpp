#include "haptic_agent/servo/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <system_error>

#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {

int request_fifo(int priority) noexcept {
  const sched_param wanted{.sched_priority = priority};
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted);
}

RealtimeReport make_realtime(int priority) {
  RealtimeReport report;
  if (const int failed = request_fifo(priority); failed == 0) {
    report.fifo = true;
  } else {
    report.warning = join({"no real-time priority (", std::generic_category().message(failed),
                           "): the 1 kHz loop runs as an ordinary thread; allow it with rtprio in "
                           "limits.conf or CAP_SYS_NICE"});
  }
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
    report.memory_locked = true;
  } else {
    if (!report.warning.empty()) report.warning += "; ";
    report.warning += join({"memory is not locked (", std::generic_category().message(errno), ")"});
  }
  return report;
}

}  // namespace kerf::agent
