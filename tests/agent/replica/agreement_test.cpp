// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/replica/agreement.h"

#include "tests/support/test.h"

namespace kerf::agent::agreement_test {
namespace {

TEST(Agreement, ReportsAPersistentDifference) {
  Agreement agreement;
  wire::Result local, remote;
  const auto answer = [&](float local_n, float remote_n, int times) {
    for (int n = 0; n < times; ++n) {
      local.agent_time_us = remote.agent_time_us = local.agent_time_us + 1000;
      local.force_n = {local_n, 0, 0};
      remote.force_n = {remote_n, 0, 0};
      agreement.note(local);
      agreement.compare(remote.agent_time_us, Vec3(remote.force_n));
    }
  };
  answer(1.0F, 1.1F, 3001);  // the first answer is not compared, because its start is unknown
  EXPECT_FALSE(agreement.take_divergence());
  answer(0.0F, 1.0F, 900);  // other agents' cuts arrive with delay
  answer(1.0F, 1.0F, 100);
  EXPECT_TRUE(agreement.take_divergence());
  EXPECT_FALSE(agreement.take_divergence()) << "once";
  answer(0.03F, 0.0F, 2000);
  EXPECT_FALSE(agreement.take_divergence()) << "below the threshold";
}

/// The n-th answer of a replica, for a sample at 1000 n.
wire::Result nth(std::uint64_t n, double newtons) {
  return wire::Result{.agent_time_us = 1000 * n, .force_n = {static_cast<float>(newtons), 0, 0}};
}

TEST(Agreement, ComparesAnswersToTheSameSample) {
  Agreement agreement;
  for (std::uint64_t n = 1; n <= 5000; ++n) {
    agreement.note(nth(n, static_cast<double>(n)));
    if (n <= 1000) continue;  // the server is a second late
    agreement.compare(1000 * (n - 1000), {static_cast<double>(n - 1000), 0, 0});
  }
  EXPECT_EQ(agreement.compared(), 3999U) << "all but the first, whose beginning is unknown";
  EXPECT_EQ(agreement.error(), 0);
  agreement.compare(999, {1, 0, 0});
  EXPECT_EQ(agreement.compared(), 3999U);
}

TEST(Agreement, ComparesTheMeanOverABatchOfSamples) {
  Agreement agreement;
  double impulse = 0;
  std::uint64_t before = 0, answered = 0;
  // Every third sample is 5 ms after its predecessor: ticks were lost.
  for (std::uint64_t n = 1, time = 1; n <= 400; ++n, time += n % 3 == 0 ? 5 : 1) {
    const double newtons = n % 2 == 0 ? 3 : 1;
    agreement.note(nth(time, newtons));
    impulse += newtons * static_cast<double>(time - before);
    if (n % 4 == 0) {
      agreement.compare(1000 * time, {impulse / static_cast<double>(time - answered), 0, 0});
      answered = time;
      impulse = 0;
    }
    before = time;
  }
  EXPECT_EQ(agreement.compared(), 99U);
  EXPECT_LT(agreement.error(), 1e-12);
}

TEST(Agreement, IgnoresABatchTheReplicaAnsweredPartially) {
  Agreement agreement;
  for (std::uint64_t n = 1; n <= 16; ++n) {
    if (n == 6) {
      agreement.note_missing();
    } else {
      agreement.note(nth(n, 2));
    }
    // The sample without an answer of the replica has another force.
    if (n % 4 == 0) agreement.compare(1000 * n, {n == 8 ? 5.0 : 2.0, 0, 0});
  }
  EXPECT_EQ(agreement.compared(), 2U) << "not the first, and not that with the sample";
  EXPECT_EQ(agreement.error(), 0);
}

}  // namespace
}  // namespace kerf::agent::agreement_test
