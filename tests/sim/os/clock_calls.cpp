// SPDX-License-Identifier: Apache-2.0
// Clocks, sleeps and random numbers of the C library, as the simulation has them
// (thread_calls.cpp).
#include <dlfcn.h>
#include <sys/random.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>

#include "tests/sim/os/scheduler.h"

namespace {

using namespace kerf::sim;

timespec to_timespec(Time time) { return {time / kSecond, time % kSecond}; }

Time shown(clockid_t clock) {
  static const Machine plain;
  const Machine& machine = this_machine() == nullptr ? plain : *this_machine();
  const Time monotonic = machine.monotonic(now());
  const bool is_wall = clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE;
  return is_wall ? machine.wall_ns + monotonic : monotonic;
}

/// A duration of the calling thread's machine.
void sleep_for(const timespec& time) {
  static const Machine plain;
  const Machine& machine = this_machine() == nullptr ? plain : *this_machine();
  const Time length = time.tv_sec * kSecond + time.tv_nsec;
  sleep_until(machine.when(machine.monotonic(now()) + length));
}

template <typename Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  if (!takes_turns()) {
    static const auto call = real<int (*)(clockid_t, timespec*)>("clock_gettime");
    return call(clock, time);
  }
  may_switch();
  *time = to_timespec(shown(clock));
  return 0;
}

int gettimeofday(timeval* time, void* zone) noexcept {
  if (!takes_turns()) {
    static const auto call = real<int (*)(timeval*, void*)>("gettimeofday");
    return call(time, zone);
  }
  const Time wall = shown(CLOCK_REALTIME);
  *time = {wall / kSecond, wall % kSecond / kMicrosecond};
  return 0;
}

time_t time(time_t* place) noexcept {
  if (!takes_turns()) {
    static const auto call = real<time_t (*)(time_t*)>("time");
    return call(place);
  }
  const time_t seconds = shown(CLOCK_REALTIME) / kSecond;
  if (place != nullptr) *place = seconds;
  return seconds;
}

int nanosleep(const timespec* time, timespec* left) {
  if (!takes_turns()) {
    static const auto call = real<int (*)(const timespec*, timespec*)>("nanosleep");
    return call(time, left);
  }
  sleep_for(*time);
  return 0;
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* time, timespec* left) {
  if (!takes_turns()) {
    static const auto call =
        real<int (*)(clockid_t, int, const timespec*, timespec*)>("clock_nanosleep");
    return call(clock, flags, time, left);
  }
  const Time length = time->tv_sec * kSecond + time->tv_nsec;
  const Time wait = (flags & TIMER_ABSTIME) != 0 ? length - shown(clock) : length;
  if (wait > 0) sleep_for(to_timespec(wait));
  return 0;
}

int usleep(useconds_t microseconds) {
  const timespec time = to_timespec(microseconds * kMicrosecond);
  return nanosleep(&time, nullptr);
}

ssize_t getrandom(void* bytes, std::size_t size, unsigned flags) {
  if (!takes_turns()) {
    static const auto call = real<ssize_t (*)(void*, std::size_t, unsigned)>("getrandom");
    return call(bytes, size, flags);
  }
  auto* to = static_cast<unsigned char*>(bytes);
  for (std::size_t i = 0; i < size; ++i) to[i] = static_cast<unsigned char>(draw(256));
  return static_cast<ssize_t>(size);
}

int getentropy(void* bytes, std::size_t size) { return getrandom(bytes, size, 0) < 0 ? -1 : 0; }

}  // extern "C"
