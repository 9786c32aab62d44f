// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/realtime/alarm.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "haptic_agent/realtime/clock.h"

namespace kerf::agent {

namespace {
constexpr int kWithoutTimerMs = 5;
}  // namespace

Alarm::Alarm() noexcept
    : timer_(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK)),
      ended_(::eventfd(0, EFD_CLOEXEC)) {}

Alarm::~Alarm() {
  ::close(timer_);
  ::close(ended_);
}

void Alarm::set(std::uint64_t time_ns) noexcept {
  const itimerspec at{.it_interval = {}, .it_value = timespec_of(time_ns)};
  ::timerfd_settime(timer_, TFD_TIMER_ABSTIME, &at, nullptr);
}

void Alarm::wait() noexcept {
  std::array<pollfd, 2> events{pollfd{.fd = timer_, .events = POLLIN, .revents = 0},
                               pollfd{.fd = ended_, .events = POLLIN, .revents = 0}};
  const int most_ms = timer_ >= 0 && ended_ >= 0 ? -1 : kWithoutTimerMs;
  while (::poll(events.data(), events.size(), most_ms) < 0 && errno == EINTR) {
  }
  // Reads nothing if the alarm was set again meanwhile.
  std::uint64_t times = 0;
  [[maybe_unused]] const auto read_bytes = ::read(timer_, &times, sizeof times);
}

void Alarm::end() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(ended_, &one, sizeof one);
}

}  // namespace kerf::agent
