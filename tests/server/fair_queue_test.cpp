// SPDX-License-Identifier: Apache-2.0
#include "server/threads/fair_queue.h"

#include <latch>

#include "server/threads/io_threads.h"
#include "tests/server/manual_executor.h"
#include "tests/support/test.h"

namespace kerf::fair_queue_test {
namespace {

class FairQueueTest : public testing::Test {
 protected:
  void post(FairQueue& queue, const std::string& client, const std::stop_token& stop = {}) {
    queue.post({.client = client,
                .work = [this, client] { ran.push_back(client); },
                .dropped = [this, client] { dropped.push_back(client); },
                .stop = stop});
  }
  /// Posts a job that occupies its thread for some time.
  void post_long(FairQueue& queue, const std::string& client, std::chrono::milliseconds cost) {
    queue.post({.client = client,
                .work =
                    [this, client, cost] {
                      time += cost;
                      ran.push_back(client);
                    },
                .dropped = [] {}});
  }

  test::ManualExecutor executor;
  Clock::time_point time;  ///< virtual
  const FairQueue::Now now = [this] { return time; };
  std::vector<std::string> ran, dropped;
};

using namespace std::chrono_literals;
using Names = std::vector<std::string>;

TEST_F(FairQueueTest, ClientsTakeTurns) {
  FairQueue queue(executor, 1, now);
  for (const char* client : {"a", "a", "a", "a", "b", "b", "c"}) post(queue, client);
  executor.run();
  EXPECT_EQ(ran, (Names{"a", "a", "b", "c", "a", "b", "a"}));
}

TEST_F(FairQueueTest, ReturningClientQueuesBehindWaitingOnes) {
  FairQueue queue(executor, 1, now);
  for (const char* client : {"a", "b", "c"}) post(queue, client);
  executor.run_one();
  post(queue, "a");
  executor.run();
  EXPECT_EQ(ran, (Names{"a", "b", "c", "a"}));
}

TEST_F(FairQueueTest, OneClientLeavesAThreadFree) {
  FairQueue queue(executor, 3, now);
  for (int n = 0; n < 10; ++n) post(queue, "greedy");
  EXPECT_EQ(executor.waiting(), 2U);
  post(queue, "other");
  EXPECT_EQ(executor.waiting(), 3U);
  executor.run();
  EXPECT_EQ(ran[2], "other");
  EXPECT_EQ(ran.size(), 11U);
}

TEST_F(FairQueueTest, IdleClientsGoFirst) {
  FairQueue queue(executor, 3, now);
  for (int n = 0; n < 3; ++n) post(queue, "a");
  for (int n = 0; n < 3; ++n) post(queue, "b");
  // Two jobs of a and one of b have begun. When the oldest ends, both have one.
  for (int n = 0; n < 2; ++n) post(queue, "c");
  executor.run();
  EXPECT_EQ(ran, (Names{"a", "a", "b", "c", "a", "b", "c", "b"}));
}

TEST_F(FairQueueTest, AStopEndsAWaitingJobAtOnce) {
  FairQueue queue(executor, 1, now);
  std::stop_source stop;
  post(queue, "a");
  post(queue, "b", stop.get_token());
  post(queue, "b", stop.get_token());
  post(queue, "c");
  stop.request_stop();
  EXPECT_EQ(dropped, (Names{"b", "b"}));
  EXPECT_EQ(queue.waiting(), 1U);
  executor.run();
  EXPECT_EQ(ran, (Names{"a", "c"}));
}

TEST_F(FairQueueTest, AStopLeavesAJobThatHasBegun) {
  FairQueue queue(executor, 1, now);
  std::stop_source stop;
  post(queue, "a", stop.get_token());
  stop.request_stop();
  executor.run();
  EXPECT_EQ(ran, Names{"a"});
  EXPECT_TRUE(dropped.empty());
}

TEST_F(FairQueueTest, StoppedJobIsDroppedWhenPosted) {
  FairQueue queue(executor, 1, now);
  std::stop_source stop;
  stop.request_stop();
  post(queue, "a", stop.get_token());
  EXPECT_EQ(dropped, Names{"a"});
  EXPECT_EQ(executor.waiting(), 0U);
}

TEST_F(FairQueueTest, WaitingJobsEndWithTheQueue) {
  {
    FairQueue queue(executor, 1, now);
    post(queue, "a");
    post(queue, "b");
  }
  executor.run();
  EXPECT_EQ(ran, Names{"a"});
  EXPECT_TRUE(dropped.empty());
}

TEST_F(FairQueueTest, ExceptionReleasesTheTurn) {
  FairQueue queue(executor, 1, now);
  queue.post({.client = "a",
              .work = [] { throw std::runtime_error("thrown by a test"); },
              .dropped = [] {}});
  post(queue, "b");
  EXPECT_THROW(executor.run_one(), std::runtime_error);
  executor.run();
  EXPECT_EQ(ran, Names{"b"});
}

TEST_F(FairQueueTest, JobsOfOneTurnCountAlike) {
  FairQueue queue(executor, 1, now);
  for (int n = 0; n < 3; ++n) post_long(queue, "a", FairQueue::kTurn);
  for (int n = 0; n < 3; ++n) post_long(queue, "b", 1ms);
  executor.run();
  EXPECT_EQ(ran, (Names{"a", "a", "b", "a", "b", "b"}));
}

TEST_F(FairQueueTest, ACostlyJobIsPaidWithTurns) {
  FairQueue queue(executor, 1, now);
  for (int n = 0; n < 2; ++n) post_long(queue, "a", 4 * FairQueue::kTurn);
  for (int n = 0; n < 6; ++n) post_long(queue, "b", FairQueue::kTurn);
  executor.run();
  EXPECT_EQ(ran, (Names{"a", "b", "b", "b", "a", "b", "b", "b"}));
}

TEST_F(FairQueueTest, NewClientDoesNotWaitForTurnsThatOthersGiveUp) {
  FairQueue queue(executor, 1, now);
  for (int n = 0; n < 3; ++n) post_long(queue, "a", 1min);
  for (int n = 0; n < 3; ++n) post_long(queue, "b", 1s);
  executor.run_one();
  executor.run_one();
  post_long(queue, "c", 1s);
  executor.run();
  EXPECT_EQ(ran, (Names{"a", "b", "b", "c", "b", "a", "a"})) << "the second job of b had begun";
}

TEST_F(FairQueueTest, AnExcessOutlastsTheJobsOfItsClient) {
  FairQueue queue(executor, 1, now);
  post_long(queue, "a", 1s);
  for (int n = 0; n < 3; ++n) post_long(queue, "b", 10ms);
  executor.run_one();
  post_long(queue, "a", 1s);
  executor.run();
  EXPECT_EQ(ran, (Names{"a", "b", "b", "b", "a"}));
}

TEST_F(FairQueueTest, TimeThatNobodyWaitedForIsFree) {
  FairQueue queue(executor, 1, now);
  post_long(queue, "a", 1h);
  executor.run();
  post_long(queue, "a", 1s);
  post_long(queue, "b", 1s);
  executor.run();
  EXPECT_EQ(ran, (Names{"a", "a", "b"}));
}

/// New clients that arrive for ever must not keep one from its turn.
TEST_F(FairQueueTest, AnExcessEndsAlthoughNewClientsArrive) {
  FairQueue queue(executor, 1, now);
  for (int n = 0; n < 2; ++n) post_long(queue, "a", 1s);
  int arrived = 0;
  do {
    post_long(queue, "new" + std::to_string(++arrived), 10ms);
    executor.run_one();
  } while (std::ranges::count(ran, "a") < 2 && arrived < 1000);
  EXPECT_LE(arrived, 102);
}

/// Clients with jobs of different costs always wait. Each must get the same time on the thread.
TEST_F(FairQueueTest, WaitingClientsGetTheSameTime) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    const int clients = 2 + static_cast<int>(random() % 6);
    FairQueue queue(executor, 1, now);
    std::map<std::string, std::chrono::milliseconds> used;
    const std::function<void(std::string, unsigned)> repeat = [&](const std::string& name,
                                                                  unsigned most_ms) {
      const std::chrono::milliseconds cost(FairQueue::kTurn.count() + random() % most_ms);
      queue.post({.client = name,
                  .work =
                      [&, name, most_ms, cost] {
                        time += cost;
                        used[name] += cost;
                        if (used[name] < 100s) repeat(name, most_ms);
                      },
                  .dropped = [] {}});
    };
    for (int n = 0; n < clients; ++n) {
      const std::string name(1, static_cast<char>('a' + n));
      used[name] = 0s;
      repeat(name, n == 0 ? 5000U : 1 + static_cast<unsigned>(random()) % 5000U);
    }
    const auto all_wait = [&] {
      return std::ranges::all_of(used, [](const auto& each) { return each.second < 100s; });
    };
    while (all_wait()) executor.run_one();
    const auto [least, most] = std::ranges::minmax(std::views::values(used));
    EXPECT_LE(most - least, 5s + 5 * FairQueue::kTurn) << "at most one job, seed " << seed;
    executor.run();
  }
}

/// The numbers of jobs that had run when the only job of a client was posted.
struct Posted {
  std::map<std::string, int> ran;
  std::size_t total = 0, begun = 0;
};

/// Random arrivals, including bursts of one client. The only job of a client must not wait for more
/// than the jobs in progress and one job of each other client.
class Arrivals {
 public:
  explicit Arrivals(std::uint32_t seed)
      : random_(seed),
        parallel_(1 + static_cast<int>(seed % 4)),
        clients_(2 + static_cast<int>(seed / 4 % 6)),
        queue_(executor_, parallel_, [this] { return time_; }) {}

  void run() {
    for (int step = 0; step < 400; ++step) {
      const int choice = pick(10);
      if (choice == 0) {
        for (int n = pick(20); n > 0; --n) post(0);  // one client posts all at once
      } else if (choice < 5) {
        post(pick(clients_));
      } else {
        executor_.run_one();
      }
      EXPECT_LE(executor_.waiting(), static_cast<std::size_t>(parallel_));
    }
    executor_.run();
    for (const auto& [name, count] : outstanding_) EXPECT_EQ(count, 0) << name;
  }

 private:
  int pick(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }

  void post(int number) {
    const std::string client(1, static_cast<char>('a' + number));
    const bool alone = outstanding_[client]++ == 0;
    const Posted before{ran_, total_, executor_.waiting()};
    queue_.post({.client = client,
                 .work = [this, client, alone, before] { took_turn(client, alone, before); },
                 .dropped = [] {}});
  }

  void took_turn(const std::string& client, bool alone, const Posted& before) {
    --outstanding_[client];
    if (alone) {
      EXPECT_LE(total_ - before.total, before.begun + static_cast<std::size_t>(clients_ - 1));
      for (const auto& [other, count] : ran_) {
        const auto then = before.ran.find(other);
        const int since = count - (then == before.ran.end() ? 0 : then->second);
        EXPECT_LE(since, 1 + std::max(1, parallel_ - 1)) << client << " waited for " << other;
      }
    }
    ++ran_[client];
    ++total_;
  }

  std::mt19937 random_;
  int parallel_, clients_;
  test::ManualExecutor executor_;
  Clock::time_point time_;  ///< stands still, so that no client has an excess
  FairQueue queue_;
  std::map<std::string, int> outstanding_, ran_;
  std::size_t total_ = 0;
};

TEST(FairQueueProperty, NobodyWaitsForMoreThanOneJobOfEachOtherClient) {
  for (std::uint32_t seed = 0; seed < 500; ++seed) {
    Arrivals(seed).run();
    ASSERT_FALSE(testing::Test::HasFailure()) << "seed " << seed;
  }
}

TEST(FairQueueThreads, EveryJobRunsOrIsDropped) {
  constexpr int kPosters = 3, kJobs = 500;
  std::atomic<int> ran = 0, dropped = 0;
  std::latch all(kPosters * kJobs);
  const auto count = [&all](std::atomic<int>& which) {
    ++which;
    all.count_down();
  };
  IoThreads threads("fair", 3, 0);
  FairQueue queue(threads, 3);
  {
    std::vector<std::jthread> posters;
    for (int poster = 0; poster < kPosters; ++poster) {
      posters.emplace_back([&, poster] {
        for (int n = 0; n < kJobs; ++n) {
          std::stop_source stop;
          queue.post({.client = std::to_string((poster + n) % 4),
                      .work = [&] { count(ran); },
                      .dropped = [&] { count(dropped); },
                      .stop = stop.get_token()});
          if (n % 2 == 0) stop.request_stop();
        }
      });
    }
  }
  all.wait();
  EXPECT_EQ(ran + dropped, kPosters * kJobs);
}

}  // namespace
}  // namespace kerf::fair_queue_test
