// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/replica/agreement.h"

#include <gtest/gtest.h>

namespace kerf::agent {
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
      agreement.compare(remote);
    }
  };
  answer(1.0F, 1.1F, 3000);
  EXPECT_FALSE(agreement.take_divergence());
  answer(0.0F, 1.0F, 900);  // other agents' cuts arrive with delay
  answer(1.0F, 1.0F, 100);
  EXPECT_TRUE(agreement.take_divergence());
  EXPECT_FALSE(agreement.take_divergence()) << "once";
  answer(0.03F, 0.0F, 2000);
  EXPECT_FALSE(agreement.take_divergence()) << "below the threshold";
}

TEST(Agreement, ComparesAnswersToTheSameSample) {
  Agreement agreement;
  for (std::uint64_t n = 1; n <= 5000; ++n) {
    wire::Result local;
    local.agent_time_us = 1000 * n;
    local.force_n = {static_cast<float>(n), 0, 0};
    agreement.note(local);
    if (n <= 1000) continue;
    wire::Result remote;  // a second late
    remote.agent_time_us = 1000 * (n - 1000);
    remote.force_n = {static_cast<float>(n - 1000), 0, 0};
    agreement.compare(remote);
  }
  EXPECT_EQ(agreement.compared(), 4000U);
  EXPECT_EQ(agreement.error(), 0);
  wire::Result unknown;
  unknown.agent_time_us = 999;
  agreement.compare(unknown);
  EXPECT_EQ(agreement.compared(), 4000U);
}

TEST(Agreement, ComparesTheMeanOverABatchOfSamples) {
  Agreement agreement;
  float sum_n = 0;
  for (std::uint64_t n = 1; n <= 400; ++n) {
    wire::Result answer;
    answer.agent_time_us = 1000 * n;
    answer.force_n = {n % 2 == 0 ? 3.0F : 1.0F, 0, 0};
    agreement.note(answer);
    sum_n += answer.force_n.x;
    if (n % 4 != 0) continue;
    answer.force_n.x = sum_n / 4;
    if (n > 4) agreement.compare(answer);
    sum_n = 0;
  }
  EXPECT_EQ(agreement.compared(), 99U);
  EXPECT_LT(agreement.error(), 0.06) << "but for the first, whose beginning is unknown";
}

}  // namespace
}  // namespace kerf::agent
