// SPDX-License-Identifier: Apache-2.0
#include "server/threads/thread_pool.h"

#include "tests/support/test.h"

namespace kerf::thread_pool_test {
namespace {

TEST(ThreadPool, RunsEachJobOnce) {
  for (const int threads : {1, 2, 7}) {
    ThreadPool pool(threads);
    EXPECT_EQ(pool.count(), threads);
    for (const int jobs : {0, 1, 2, 1000}) {
      std::vector<std::atomic<int>> done(std::size_t(jobs) + 1);
      pool.run(jobs, [&](int i) { ++done[std::size_t(i)]; });
      for (int i = 0; i < jobs; ++i) EXPECT_EQ(done[std::size_t(i)], 1) << i;
      EXPECT_EQ(done[std::size_t(jobs)], 0);
    }
  }
}

// On a loaded machine some runs finish without helpers.
TEST(ThreadPool, HelpersThatSleepAtOnceAreWoken) {
  using Clock = std::chrono::steady_clock;
  ThreadPool pool(2, ThreadPool::Idle::kSleeps);
  int helped = 0;
  const auto end = Clock::now() + std::chrono::seconds(20);
  while (helped < 3 && Clock::now() < end) {
    std::atomic<int> waiting = 0;
    std::atomic<bool> met = false;
    const auto until = Clock::now() + std::chrono::milliseconds(20);
    pool.run(2, [&](int) {
      if (++waiting == 2) met = true;
      while (!met && Clock::now() < until) std::this_thread::yield();
      --waiting;
    });
    if (met) ++helped;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_EQ(helped, 3) << "the caller did all jobs";
}

TEST(ThreadPool, ManyShortRunsFollowEachOther) {
  ThreadPool pool(3);
  std::int64_t sum = 0;
  for (int run = 0; run < 20000; ++run) {
    int found[4] = {};
    pool.run(4, [&](int i) { found[i] = run + i; });
    for (int i = 0; i < 4; ++i) sum += found[i] - run;
  }
  EXPECT_EQ(sum, 20000 * 6);
}

TEST(ThreadPool, JobsRunAtTheSameTime) {
  ThreadPool pool(2);
  // Each of the two jobs waits for the other: one thread alone would never finish.
  std::atomic<int> arrived = 0;
  pool.run(2, [&](int) {
    ++arrived;
    while (arrived < 2) std::this_thread::yield();
  });
  EXPECT_EQ(arrived, 2);
}

TEST(ThreadPool, ACallerThatFindsThePoolBusyWorksAlone) {
  ThreadPool pool(2);
  std::set<std::thread::id> inner;
  std::mutex mutex;
  std::atomic<bool> done = false;
  pool.run(2, [&](int i) {
    if (i == 1) {
      while (!done) std::this_thread::yield();
      return;
    }
    std::thread([&] {
      pool.run(50, [&](int) {
        const std::scoped_lock lock(mutex);
        inner.insert(std::this_thread::get_id());
      });
    }).join();
    done = true;
  });
  EXPECT_EQ(inner.size(), 1u);
}

TEST(ThreadPool, ADelayedCallerWorksAloneForSomeRuns) {
  ThreadPool pool(2);
  // The helper starts a job and blocks for longer than the caller has worked, as if it had lost its
  // core.
  std::atomic<bool> begun = false;
  const auto start = std::chrono::steady_clock::now();
  const auto caller = std::this_thread::get_id();
  pool.run(2, [&](int) {
    if (std::this_thread::get_id() == caller) {
      while (!begun) std::this_thread::yield();
    } else {
      begun = true;
      const auto passed = std::chrono::steady_clock::now() - start;
      std::this_thread::sleep_for(passed + std::chrono::milliseconds(20));
    }
  });
  ASSERT_TRUE(begun);
  std::set<std::thread::id> threads;
  pool.run(8, [&](int) { threads.insert(std::this_thread::get_id()); });
  EXPECT_EQ(threads, std::set{caller});
  // Then helpers work again: each of two jobs waits for the other.
  std::atomic<int> arrived = 0;
  pool.run(2, [&](int) {
    ++arrived;
    while (arrived < 2) std::this_thread::yield();
  });
  EXPECT_EQ(arrived, 2);
}

TEST(ThreadPool, ThrowsTheExceptionOfTheLowestFailedJob) {
  // Also in a pool of one thread, and while the caller works alone after a delay.
  ThreadPool several(4), one(1);
  for (int repetition = 0; repetition < 100; ++repetition) {
    ThreadPool& pool = repetition % 2 == 0 ? several : one;
    std::atomic<int> ended = 0;
    try {
      pool.run(20, [&](int i) {
        ++ended;
        if (i == 3 || i == 17) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "3");
    }
    EXPECT_GE(ended, 4);
    EXPECT_LE(ended, 20);
  }
  int sum = 0;
  several.run(1, [&](int) { ++sum; });
  EXPECT_EQ(sum, 1);
}

TEST(ThreadPool, UsableThreadsIsPositive) { EXPECT_GE(usable_threads(), 1); }

}  // namespace
}  // namespace kerf::thread_pool_test
