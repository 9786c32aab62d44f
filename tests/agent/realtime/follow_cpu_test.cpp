// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/realtime/follow_cpu.h"

#include <pthread.h>

#include "tests/support/test.h"

namespace kerf::agent::follow_cpu_test {
namespace {

constexpr std::uint64_t kMs = 1'000'000;

/// Wakes a thread every two milliseconds over `windows` windows. It works for `busy_ns` each time.
template <class Choice>
void work(Choice& choice, std::uint64_t& now_ns, std::uint64_t busy_ns, int windows = 1) {
  const std::uint64_t end_ns = now_ns + (windows * PlaceChoice::kWindowNs) + (4 * kMs);
  for (; now_ns < end_ns; now_ns += 2 * kMs) {
    choice.begin(now_ns);
    choice.end(now_ns + busy_ns);
  }
}

TEST(PlaceChoice, LightThreadSharesTheLoopsProcessorAndHeavyOneDoesNot) {
  PlaceChoice choice;
  std::uint64_t now_ns = kMs;
  choice.begin(now_ns);
  choice.end(now_ns + 1000);
  EXPECT_EQ(choice.place(), Place::kAnywhere);
  work(choice, now_ns, kMs / 10);
  EXPECT_EQ(choice.place(), Place::kBeside);
  work(choice, now_ns, kMs * 3 / 2, 2);
  EXPECT_EQ(choice.place(), Place::kApart);
}

TEST(PlaceChoice, ThreadStaysBetweenTheLimits) {
  PlaceChoice choice;
  std::uint64_t now_ns = kMs;
  work(choice, now_ns, kMs / 10);
  work(choice, now_ns, kMs * 7 / 10, 3);
  EXPECT_EQ(choice.place(), Place::kBeside);
  work(choice, now_ns, kMs * 3 / 2, 2);
  work(choice, now_ns, kMs * 7 / 10, 3);
  EXPECT_EQ(choice.place(), Place::kApart);
}

TEST(PlaceChoice, LongWorkMovesTheThreadAwayAtOnce) {
  PlaceChoice choice;
  std::uint64_t now_ns = kMs;
  work(choice, now_ns, kMs / 10);
  choice.begin(now_ns);
  choice.end(now_ns + PlaceChoice::kLongNs + 1);
  EXPECT_EQ(choice.place(), Place::kApart);
}

TEST(PlaceChoice, ThreadLeavesBeforeAnnouncedLongWork) {
  PlaceChoice choice;
  std::uint64_t now_ns = kMs;
  work(choice, now_ns, kMs / 10);
  choice.begin(now_ns);
  choice.leave(now_ns);
  EXPECT_EQ(choice.place(), Place::kApart);
  work(choice, now_ns, kMs / 10, 2);
  EXPECT_EQ(choice.place(), Place::kBeside);
  choice.reset();
  EXPECT_EQ(choice.place(), Place::kAnywhere);
}

cpu_set_t processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  EXPECT_EQ(pthread_getaffinity_np(pthread_self(), sizeof set, &set), 0);
  return set;
}

class FollowCpuTest : public testing::Test {
 protected:
  void SetUp() override {
    if (CPU_COUNT(&all_) < 2) GTEST_SKIP() << "needs two processors";
  }
  /// Expects this set of processors for the calling thread.
  void expect(const cpu_set_t& wanted) {
    const cpu_set_t now = processors();
    EXPECT_TRUE(CPU_EQUAL(&now, &wanted));
  }
  const cpu_set_t all_ = processors();
};

TEST_F(FollowCpuTest, ThreadMovesToTheLoopThenAwayThenAnywhere) {
  LeadCpu lead;
  lead.note();
  std::thread([&] {
    FollowCpu place(&lead);
    std::uint64_t now_ns = kMs;
    work(place, now_ns, kMs / 10);
    cpu_set_t only;
    CPU_ZERO(&only);
    CPU_SET(static_cast<std::size_t>(lead.cpu()), &only);
    expect(only);
    place.leave(now_ns);
    cpu_set_t others = all_;
    CPU_CLR(static_cast<std::size_t>(lead.cpu()), &others);
    expect(others);
    place.release();
    expect(all_);
  }).join();
}

TEST_F(FollowCpuTest, WithoutARealTimeLoopNothingChanges) {
  LeadCpu lead;
  std::thread([&] {
    for (const LeadCpu* none :
         {static_cast<const LeadCpu*>(nullptr), static_cast<const LeadCpu*>(&lead)}) {
      FollowCpu place(none);
      std::uint64_t now_ns = kMs;
      work(place, now_ns, kMs / 10);
      place.leave(now_ns);
      EXPECT_EQ(place.place(), Place::kAnywhere);
      expect(all_);
    }
  }).join();
}

TEST_F(FollowCpuTest, WhenTheLoopEndsTheThreadMayUseAllProcessorsAgain) {
  LeadCpu lead;
  lead.note();
  std::thread([&] {
    FollowCpu place(&lead);
    std::uint64_t now_ns = kMs;
    work(place, now_ns, kMs / 10);
    EXPECT_EQ(place.place(), Place::kBeside);
    lead.forget();
    work(place, now_ns, kMs / 10);
    expect(all_);
  }).join();
}

TEST_F(FollowCpuTest, ForbiddenProcessorIsNotFollowed) {
  LeadCpu lead;
  lead.note();
  std::thread([&] {
    cpu_set_t others = all_;
    CPU_CLR(static_cast<std::size_t>(lead.cpu()), &others);
    ASSERT_EQ(pthread_setaffinity_np(pthread_self(), sizeof others, &others), 0);
    FollowCpu place(&lead);
    std::uint64_t now_ns = kMs;
    work(place, now_ns, kMs / 10);
    EXPECT_EQ(place.place(), Place::kAnywhere);
    expect(others);
  }).join();
}

}  // namespace
}  // namespace kerf::agent::follow_cpu_test
