// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/os/scheduler.h"

#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/test.h"

namespace kerf::sim::scheduler_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// Runs `work` in a simulation, in a process of its own; returns what it has printed.
std::string simulate(std::uint64_t seed, const std::function<std::string()>& work,
                     double switch_chance = 0.2) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    const auto say = [&](const std::string& text) {
      (void)!write(ends[1], text.data(), text.size());
    };
    begin_turns({.seed = seed, .switch_chance = switch_chance, .turns_max = 1'000'000},
                [&](const std::string& reason) { say(reason.substr(0, reason.find('\n'))); });
    say(work());
    _exit(0);
  }
  close(ends[1]);
  std::string text;
  char part[256];
  for (ssize_t size = 0; (size = read(ends[0], part, sizeof part)) > 0;) {
    text.append(part, static_cast<std::size_t>(size));
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  return text;
}

/// Two threads that add to a text, without a lock.
std::string interleave() {
  std::string text;
  std::mutex mutex;
  const auto add = [&](char letter) {
    for (int i = 0; i < 8; ++i) {
      const std::lock_guard lock(mutex);
      text += letter;
    }
  };
  std::thread a(add, 'a'), b(add, 'b');
  a.join();
  b.join();
  return text + " " + std::to_string(trace());
}

TEST(Scheduler, EqualSeedsGiveEqualRunsAndOthersDoNot) {
  std::vector<std::string> runs;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    runs.push_back(simulate(seed, interleave));
    EXPECT_EQ(simulate(seed, interleave), runs.back());
  }
  std::ranges::sort(runs);
  EXPECT_EQ(std::unique(runs.begin(), runs.end()), runs.end());
}

TEST(Scheduler, TimePassesOnlyWhileAllWait) {
  const std::string hours = simulate(1, [] {
    const auto begin = steady_clock::now();
    std::mutex mutex;
    std::condition_variable never;
    std::unique_lock lock(mutex);
    never.wait_for(lock, std::chrono::hours(100));
    std::this_thread::sleep_until(begin + std::chrono::hours(101));
    const auto passed = steady_clock::now() - begin;
    return std::to_string(std::chrono::duration_cast<std::chrono::hours>(passed).count());
  });
  EXPECT_EQ(hours, "101");
}

TEST(Scheduler, FindsARaceThatNeedsOneInterleaving) {
  // Reads, and writes what it has read later.
  const auto race = [] {
    int sum = 0;
    std::mutex mutex;
    const auto add = [&] {
      int seen = 0;
      {
        const std::lock_guard lock(mutex);
        seen = sum;
      }
      const std::lock_guard lock(mutex);
      sum = seen + 1;
    };
    std::thread a(add), b(add);
    a.join();
    b.join();
    return std::to_string(sum);
  };
  int lost = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) lost += simulate(seed, race) == "1" ? 1 : 0;
  EXPECT_GT(lost, 0);
  EXPECT_LT(lost, 40);
}

TEST(Scheduler, ReportsThreadsThatWaitForEachOther) {
  const std::string said = simulate(1, [] {
    std::mutex first, second;
    std::promise<void> both_locked;
    const std::lock_guard lock(first);
    std::thread other([&] {
      const std::lock_guard theirs(second);
      both_locked.set_value();
      const std::lock_guard ours(first);
    });
    both_locked.get_future().wait();
    const std::lock_guard never(second);
    return std::string("locked");
  });
  EXPECT_EQ(said, "all threads wait for each other, for ever");
}

TEST(Scheduler, ReportsThreadsThatDoNotComeToAnEnd) {
  const std::string said = simulate(1, [] {
    std::atomic<bool> never = false;
    while (!never) std::this_thread::yield();
    return std::string();
  });
  EXPECT_EQ(said, "the threads do not come to an end");
}

TEST(Scheduler, ThreadsOfABusyMachineAreLateAndAllRun) {
  const auto latest_ms = [](bool is_busy) {
    return simulate(2, [is_busy] {
      Machine machine{.name = "one", .is_busy = is_busy};
      Time latest = 0;
      enter(&machine);
      std::thread worker([&] {
        for (int n = 0; n < 100; ++n) {
          const Time due = now() + kMillisecond;
          sleep_until(due);
          latest = std::max(latest, now() - due);
        }
      });
      enter(nullptr);
      worker.join();
      return std::to_string(latest / kMillisecond);
    });
  };
  EXPECT_EQ(latest_ms(false), "0");
  EXPECT_GT(std::stoi(latest_ms(true)), 50);
  EXPECT_LE(std::stoi(latest_ms(true)), Machine::kCoreWait / kMillisecond);
}

TEST(Scheduler, ThreadsOfAMachineThatIsGoneRunNoMore) {
  const std::string said = simulate(3, [] {
    Machine machine{.name = "one"};
    int steps = 0;
    enter(&machine);
    std::thread worker([&] {
      for (;;) {
        std::this_thread::sleep_for(milliseconds(1));
        ++steps;
      }
    });
    enter(nullptr);
    std::this_thread::sleep_for(milliseconds(100));
    const int before = steps;
    end_threads_of(machine);
    std::this_thread::sleep_for(milliseconds(100));
    worker.detach();
    return std::to_string(before > 10) + std::to_string(steps - before);
  });
  EXPECT_EQ(said, "10");
}

TEST(Scheduler, MachinesHaveClocksOfTheirOwn) {
  const std::string said = simulate(1, [] {
    Machine fast{.name = "fast", .boot_ns = 5 * kSecond, .rate = 1.25};
    long fast_ms = 0, sleeps_ms = 0;
    enter(&fast);
    std::thread worker([&] {
      const auto begin = steady_clock::now();
      std::this_thread::sleep_for(std::chrono::seconds(10));
      fast_ms = std::chrono::duration_cast<milliseconds>(steady_clock::now() - begin).count();
    });
    enter(nullptr);
    const auto begin = steady_clock::now();
    worker.join();
    sleeps_ms = std::chrono::duration_cast<milliseconds>(steady_clock::now() - begin).count();
    return std::to_string(fast_ms) + " " + std::to_string(sleeps_ms);
  });
  EXPECT_EQ(said, "10000 8000");
}

}  // namespace
}  // namespace kerf::sim::scheduler_test
