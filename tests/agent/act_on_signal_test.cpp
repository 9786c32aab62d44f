// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/act_on_signal.h"

#include <unistd.h>

#include "tests/support/eventually.h"
#include "tests/support/test.h"

namespace kerf::agent::act_on_signal_test {
namespace {

using test::eventually;

TEST(ActOnSignal, EachSignalRunsItsAction) {
  std::atomic<int> left{0}, rearmed{0};
  ActOnSignal signals;
  signals.on_leave([&left] { ++left; });
  signals.on_rearm([&rearmed] { ++rearmed; });
  ::kill(::getpid(), SIGUSR1);
  EXPECT_TRUE(eventually([&] { return rearmed == 1; }));
  EXPECT_EQ(left, 0);
  ::kill(::getpid(), SIGINT);
  EXPECT_TRUE(eventually([&] { return left == 1; }));
  ::kill(::getpid(), SIGTERM);
  EXPECT_TRUE(eventually([&] { return left == 2; }));
  EXPECT_EQ(rearmed, 1);
}

TEST(ActOnSignal, EarlySignalRunsTheActionSetLater) {
  std::atomic<int> first{0}, second{0};
  ActOnSignal signals;
  signals.on_leave([&first] { ++first; });
  ::kill(::getpid(), SIGINT);
  ASSERT_TRUE(eventually([&] { return first == 1; }));
  signals.on_leave([&second] { ++second; });
  EXPECT_EQ(second, 1) << "at once";
  signals.on_leave({});
  EXPECT_EQ(first, 1);
}

TEST(ActOnSignal, RemovedActionDoesNotRun) {
  std::atomic<int> before{0}, after{0};
  ActOnSignal signals;
  signals.on_rearm([&before] { ++before; });
  signals.on_rearm({});
  signals.on_leave([&after] { ++after; });
  ::kill(::getpid(), SIGUSR1);
  EXPECT_TRUE(eventually([] {
    sigset_t pending{};
    sigpending(&pending);
    return sigismember(&pending, SIGUSR1) == 0;
  }));
  ::kill(::getpid(), SIGTERM);
  EXPECT_TRUE(eventually([&] { return after == 1; })) << "so the earlier signal has been handled";
  EXPECT_EQ(before, 0);
}

TEST(ActOnSignal, PendingSignalsDoNotEndTheProgramAfterwards) {
  sigset_t blocked{};
  {
    ActOnSignal signals;
    for (int i = 0; i < 3; ++i) ::kill(::getpid(), SIGUSR1);
  }
  pthread_sigmask(SIG_SETMASK, nullptr, &blocked);
  EXPECT_EQ(sigismember(&blocked, SIGUSR1), 0) << "as before";
}

}  // namespace
}  // namespace kerf::agent::act_on_signal_test
