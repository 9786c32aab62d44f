// SPDX-License-Identifier: Apache-2.0
#include "server/threads/io_threads.h"

#include <sched.h>
#include <sys/resource.h>

#include "server/session/session_registry.h"
#include "server/socket/peer_context.h"
#include "server/threads/run_and_wait.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::io_threads_test {
namespace {

int niceness() { return getpriority(PRIO_PROCESS, 0); }

TEST(IoThreads, RunWorkInTheOrderOfPosting) {
  IoThreads threads("test", 1, 0);
  std::vector<int> order;
  for (int n = 0; n < 100; ++n) threads.post([&order, n] { order.push_back(n); });
  const auto seen = run_and_wait(threads, [&] { return order; });
  ASSERT_EQ(seen.size(), 100U);
  EXPECT_TRUE(std::ranges::is_sorted(seen));
}

TEST(IoThreads, PostAfterWaitsForTheDelay) {
  using Clock = std::chrono::steady_clock;
  IoThreads threads("test", 1, 0);
  std::promise<Clock::time_point> ran;
  const auto start = Clock::now();
  threads.post_after(std::chrono::milliseconds(20), [&] { ran.set_value(Clock::now()); });
  EXPECT_GE(ran.get_future().get() - start, std::chrono::milliseconds(20));
}

TEST(IoThreads, NestedThreadsInheritTheNicenessOfTheirCreator) {
  const int base = niceness();
  IoThreads nice("nice", 1, 5);
  IoThreads spawner("spawner", 1, 0);
  EXPECT_EQ(run_and_wait(nice, niceness), std::max(base, 5));
  // A nice thread calls the spawner, like an upload that creates a session.
  const auto created = run_and_wait(nice, [&] { return spawner.create_nested("nested", 1, 0); });
  EXPECT_EQ(run_and_wait(*created, niceness), base);
}

TEST(IoThreads, OnlyAgentThreadsPreemptOnWakeup) {
  const auto policy = [] { return sched_getscheduler(0); };
  IoThreads viewers("viewers", 1, 5);
  IoThreads spawner("spawner", 1, 0);
  EXPECT_EQ(run_and_wait(viewers, policy), SCHED_BATCH);
  EXPECT_EQ(run_and_wait(*spawner.create_nested("session", 1, 0), policy), SCHED_OTHER);
}

TEST(IoThreads, AnExceptionDoesNotEndTheThread) {
  IoThreads threads("test", 1, 0);
  threads.post([] { throw std::runtime_error("thrown by a test"); });
  EXPECT_EQ(run_and_wait(threads, [] { return 7; }), 7);
}

TEST(IoThreads, MayBeDestroyedByTheirOwnWork) {
  std::promise<void> gone;
  auto threads = std::make_shared<IoThreads>("test", 1, 0);
  IoThreads& posting = *threads;
  posting.post([threads = std::move(threads), &gone]() mutable {
    threads.reset();
    gone.set_value();
  });
  gone.get_future().wait();
}

TEST(IoThreads, AreTheExecutorOfASession) {
  test::TemporaryFolder folder;
  test::ManualExecutor workers;
  auto threads = std::make_shared<IoThreads>("s:block", 1, 0);
  SessionRegistry registry(
      {folder.path(), 4, {}}, [&](const std::string&) { return threads; }, workers);
  const auto session = test::value_of(registry.create("block", kScene, SceneSource{}));
  EXPECT_EQ(&net::threads_of(*session), threads.get());
}

}  // namespace
}  // namespace kerf::io_threads_test
