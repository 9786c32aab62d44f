// SPDX-License-Identifier: Apache-2.0
#include <pthread.h>

#include <csignal>

#include "server/platform/clock.h"
#include "server/platform/random.h"
#include "tests/support/test.h"

namespace kerf::platform_test {
namespace {

TEST(Clock, NowIsTheTimeByWhichTheStandardLibraryWaits) {
  const auto before = std::chrono::steady_clock::now();
  const Clock::time_point now = Clock::now();
  const auto after = std::chrono::steady_clock::now();
  EXPECT_LE(before, now);
  EXPECT_LE(now, after);
}

TEST(Clock, NowNeverDecreases) {
  Clock::time_point newest = Clock::now();
  for (int i = 0; i < 100'000; ++i) {
    const Clock::time_point now = Clock::now();
    ASSERT_LE(newest, now);
    newest = now;
  }
}

TEST(Clock, WallTimesAreUtcInTheirUnits) {
  // The system's clock may be adjusted slightly in the meantime.
  constexpr std::chrono::seconds kSet{60};
  const auto away = Clock::wall() - std::chrono::system_clock::now();
  EXPECT_LT(std::chrono::abs(away), kSet);
  const std::chrono::seconds since = std::chrono::duration_cast<std::chrono::seconds>(
      std::chrono::system_clock::now().time_since_epoch());
  EXPECT_NEAR(double(Clock::wall_s()), double(since.count()), double(kSet.count()));
  EXPECT_NEAR(double(Clock::wall_ms()), 1e3 * double(since.count()), 1e3 * double(kSet.count()));
}

TEST(Clock, WorkTakesCpuTimeOfItsThreadAndOfTheProcess) {
  const double process_s = Clock::process_cpu_s();
  const double thread_s = Clock::thread_cpu_s();
  volatile std::uint64_t sum = 0;
  while (Clock::thread_cpu_s() < thread_s + 1e-3) {
    for (std::uint64_t i = 0; i < 1000; ++i) sum = sum + i;
  }
  const double used_s = Clock::thread_cpu_s();
  EXPECT_GE(Clock::process_cpu_s(), std::max(used_s, process_s + 1e-3));
}

TEST(Clock, TimeSinceTheStartOfTheMachineCountsItsSleepToo) {
  const std::int64_t boot_ns = Clock::boot_ns();
  EXPECT_GE(Clock::boot_ns(), boot_ns);
  const auto awake = Clock::now().time_since_epoch();
  EXPECT_GE(Clock::boot_ns(), std::chrono::nanoseconds(awake).count());
}

TEST(Random, NumbersDiffer) {
  std::set<std::uint64_t> numbers;
  for (int i = 0; i < 1000; ++i) numbers.insert(random_number());
  EXPECT_EQ(numbers.size(), 1000u);
}

TEST(Random, FillsNothing) { EXPECT_TRUE(fill_random({})); }

TEST(Random, FillsExactlyTheGivenBytes) {
  constexpr std::byte kBefore{0xA5};
  std::array<std::byte, 96> bytes{};
  bytes.fill(kBefore);
  const auto given = std::span(bytes).subspan(32, 32);
  ASSERT_TRUE(fill_random(given));
  const auto is_as_before = [&](std::byte byte) { return byte == kBefore; };
  EXPECT_TRUE(std::ranges::all_of(std::span(bytes).first(32), is_as_before));
  EXPECT_TRUE(std::ranges::all_of(std::span(bytes).last(32), is_as_before));
  EXPECT_FALSE(std::ranges::all_of(given, is_as_before));
}

// A signal interrupts a system call that has filled a part of the buffer.
TEST(Random, FillsMuchWhileSignalsArrive) {
  struct sigaction action{};
  action.sa_handler = [](int) {};
  ASSERT_EQ(::sigaction(SIGUSR1, &action, nullptr), 0);
  std::vector<std::byte> bytes(std::size_t{1} << 23);
  const std::jthread interrupter([filler = ::pthread_self()](const std::stop_token& stop) {
    while (!stop.stop_requested()) ::pthread_kill(filler, SIGUSR1);
  });
  ASSERT_TRUE(fill_random(bytes));
  // 16 random bytes in a row are 0 once in 2^128.
  for (auto rest = std::span(bytes); !rest.empty(); rest = rest.subspan(16)) {
    ASSERT_FALSE(std::ranges::all_of(rest.first(16), [](std::byte b) { return b == std::byte{}; }));
  }
}

}  // namespace
}  // namespace kerf::platform_test
