// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/realtime/alarm.h"

#include <sys/resource.h>

#include "haptic_agent/realtime/clock.h"
#include "tests/support/test.h"

namespace kerf::agent::alarm_test {
namespace {

constexpr std::uint64_t kNsPerMs = 1'000'000;

TEST(Alarm, GoesOffAtTheTimeSetLast) {
  Alarm alarm;
  const std::uint64_t start_ns = monotonic_ns();
  alarm.set(start_ns + 2 * kNsPerMs);
  alarm.set(start_ns + 20 * kNsPerMs);
  alarm.wait();
  EXPECT_GE(monotonic_ns(), start_ns + 20 * kNsPerMs);
}

TEST(Alarm, WakesAWaiterOnce) {
  Alarm alarm;
  alarm.set(monotonic_ns() - kNsPerMs);
  alarm.wait();
  const std::uint64_t later_ns = monotonic_ns() + 10 * kNsPerMs;
  alarm.set(later_ns);
  alarm.wait();
  EXPECT_GE(monotonic_ns(), later_ns);
}

TEST(Alarm, DoesNotWaitForeverWithoutATimer) {
  rlimit files{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &files), 0);
  const rlimit none{.rlim_cur = 0, .rlim_max = files.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  Alarm alarm;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &files), 0);
  alarm.set(monotonic_ns() + 3600 * kNsPerS);
  alarm.wait();
}

TEST(Alarm, EndsTheWaitOfAnotherThread) {
  Alarm alarm;
  std::thread waits([&] { alarm.wait(); });
  alarm.end();
  waits.join();
  alarm.wait();  // and later calls
}

}  // namespace
}  // namespace kerf::agent::alarm_test
