#include "haptic_agent/link/sample_queue.h"

#include <gtest/gtest.h>

namespace kerf::agent {
namespace {

wire::MotionSample sample(std::uint64_t time_us, bool cuts = true, std::uint32_t tool = 1) {
  return {.time_us = time_us, .tool_id = tool, .buttons = cuts ? wire::kButtonCutting : 0};
}

TEST(SampleQueue, NumbersSamplesFromOneAsTheyGoOut) {
  SampleQueue queue;
  for (std::uint64_t i = 1; i <= 20; ++i) queue.push(sample(i));
  const auto first = queue.take(100);
  EXPECT_EQ(first.count, wire::kMaxSamplesPerMotion);
  EXPECT_EQ(first.samples[0].agent_sequence, 1U);
  const auto second = queue.take(100);
  EXPECT_EQ(second.count, 4U);
  EXPECT_EQ(second.samples[3].agent_sequence, 20U);
  EXPECT_EQ(queue.take(100).count, 0U);
}

TEST(SampleQueue, TakesNoMoreThanThePaceAllows) {
  SampleQueue queue;
  for (std::uint64_t i = 1; i <= 20; ++i) queue.push(sample(i));
  EXPECT_EQ(queue.take(3).count, 3U);
  EXPECT_EQ(queue.unsent(), 17U);
}

TEST(SampleQueue, AMessageHoldsOneTool) {
  SampleQueue queue;
  queue.push(sample(1, true, 1));
  queue.push(sample(2, true, 2));
  EXPECT_EQ(queue.take(16).count, 1U);
  EXPECT_EQ(queue.next_tool(), 2U);
  EXPECT_EQ(queue.take(16).samples[0].agent_sequence, 2U);
  EXPECT_FALSE(queue.next_tool());
}

TEST(SampleQueue, ARewindStartsAtTheLastAnsweredSample) {
  SampleQueue queue;
  for (std::uint64_t i = 1; i <= 10; ++i) queue.push(sample(i));
  queue.take(16);
  queue.answered(6);
  queue.push(sample(11));
  queue.rewind();
  const auto batch = queue.take(16);
  ASSERT_EQ(batch.count, 6U);
  for (std::uint32_t i = 0; i < batch.count; ++i) {
    EXPECT_EQ(batch.samples[i].agent_sequence, 6 + i);
    EXPECT_EQ(batch.samples[i].time_us, 6 + i);
  }
  EXPECT_EQ(queue.resent(), 5U);
  EXPECT_FALSE(queue.settled());
  queue.answered(11);
  EXPECT_TRUE(queue.settled());
  EXPECT_EQ(queue.unanswered(), 0U);
}

TEST(SampleQueue, AnswersToWhatWasNeverSentAreIgnored) {
  SampleQueue queue;
  queue.push(sample(1));
  queue.take(16);
  queue.answered(1000);
  EXPECT_FALSE(queue.settled());
  EXPECT_EQ(queue.unanswered(), 1U);
}

TEST(SampleQueue, WhenTheServerIsBehindMovesThroughTheAirAreMergedAndCutsAreNot) {
  SampleQueue queue;
  queue.push(sample(1, false));
  for (std::uint64_t i = 2; i <= 60; ++i) queue.push(sample(i, false));
  for (std::uint64_t i = 61; i <= 80; ++i) queue.push(sample(i, true));
  std::vector<wire::MotionSample> sent;
  for (auto batch = queue.take(16); batch.count > 0; batch = queue.take(16)) {
    sent.insert(sent.end(), batch.view().begin(), batch.view().end());
  }
  ASSERT_EQ(sent.size(), 21U);
  EXPECT_EQ(sent[0].time_us, 60U) << "where the cut begins stays";
  EXPECT_EQ(queue.merged_air(), 59U);
  EXPECT_EQ(queue.thinned_cuts(), 0U);
  for (std::size_t i = 0; i < sent.size(); ++i) EXPECT_EQ(sent[i].agent_sequence, i + 1);
}

TEST(SampleQueue, AQueueThatIsFullOfCutsIsThinnedAndNeverGrowsBeyondItsBound) {
  SampleQueue queue;
  const std::uint64_t many = 4 * SampleQueue::kMostKept;
  for (std::uint64_t i = 1; i <= many; ++i) {
    queue.push(sample(i));
    ASSERT_LE(queue.unsent(), SampleQueue::kMostKept);
  }
  EXPECT_GT(queue.thinned_cuts(), 0U);
  EXPECT_EQ(queue.forgotten(), 0U);
  const auto first = queue.take(1);
  EXPECT_EQ(first.samples[0].time_us, 1U) << "the path still begins where it began";
  std::uint64_t last = 0;
  for (auto batch = queue.take(16); batch.count > 0; batch = queue.take(16)) {
    last = batch.view().back().time_us;
  }
  EXPECT_EQ(last, many);
}

TEST(SampleQueue, WhatWasSentAndNeverAnsweredIsForgottenInTheEnd) {
  SampleQueue queue;
  for (std::uint64_t i = 1; i <= SampleQueue::kMostKept + 100; ++i) {
    queue.push(sample(i));
    queue.take(1);
  }
  EXPECT_EQ(queue.forgotten(), 100U);
  queue.rewind();
  EXPECT_EQ(queue.take(16).samples[0].agent_sequence, 101U);
}

}  // namespace
}  // namespace kerf::agent
