// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/link/sample_queue.h"

#include "tests/support/test.h"

namespace kerf::agent::sample_queue_test {
namespace {

/// A path that bends at every sample, so that none may be merged.
wire::MotionSample sample(std::uint64_t time_us, bool cuts = true, std::uint32_t tool = 1) {
  const double x = 0.1 * static_cast<double>(time_us);
  return {.time_us = time_us,
          .tip_mm = {x, time_us % 2 == 0 ? 0.1 : 0.0, 0},
          .tool_id = tool,
          .buttons = cuts ? wire::kButtonCutting : 0};
}

std::vector<wire::MotionSample> take_all(SampleQueue& queue) {
  std::vector<wire::MotionSample> sent;
  for (auto batch = queue.take(16); batch.count > 0; batch = queue.take(16)) {
    sent.insert(sent.end(), batch.view().begin(), batch.view().end());
  }
  return sent;
}

TEST(SampleQueue, NumbersSamplesFromOneWhenSent) {
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

TEST(SampleQueue, TakesAtMostTheRequestedNumber) {
  SampleQueue queue;
  for (std::uint64_t i = 1; i <= 20; ++i) queue.push(sample(i));
  EXPECT_EQ(queue.take(3).count, 3U);
  EXPECT_EQ(queue.unsent(), 17U);
}

TEST(SampleQueue, MessageContainsOneTool) {
  SampleQueue queue;
  queue.push(sample(1, true, 1));
  queue.push(sample(2, true, 2));
  EXPECT_EQ(queue.take(16).count, 1U);
  EXPECT_EQ(queue.next_tool(), 2U);
  EXPECT_EQ(queue.take(16).samples[0].agent_sequence, 2U);
  EXPECT_FALSE(queue.next_tool());
}

TEST(SampleQueue, RewindStartsAtTheLastAnsweredSample) {
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

TEST(SampleQueue, AnsweredSamplesAreKeptUntilTheyAreDurable) {
  SampleQueue queue;
  queue.keep_until_durable(true);
  for (std::uint64_t i = 1; i <= 10; ++i) queue.push(sample(i));
  queue.take(16);
  queue.answered(8);
  queue.durable(3);
  EXPECT_EQ(queue.not_durable(), 5U);
  // The server was killed, so it has only the durable samples.
  queue.rewind(3);
  auto batch = queue.take(16);
  ASSERT_EQ(batch.count, 8U);
  EXPECT_EQ(batch.samples[0].agent_sequence, 3U) << "the start of the first motion";
  EXPECT_EQ(batch.samples[7].time_us, 10U);
  queue.answered(10);
  EXPECT_TRUE(queue.settled());
  EXPECT_EQ(queue.not_durable(), 7U);
  // Only the connection was lost: the server has everything, including samples without an answer.
  queue.push(sample(11));
  queue.take(16);
  queue.rewind(11);
  batch = queue.take(16);
  ASSERT_EQ(batch.count, 1U);
  EXPECT_EQ(batch.samples[0].agent_sequence, 11U);
  // A server that does not know the agent gets all samples that are not durable.
  queue.rewind(0);
  EXPECT_EQ(queue.take(16).samples[0].agent_sequence, 3U);
  queue.durable(11);
  queue.rewind(0);
  EXPECT_EQ(queue.take(16).samples[0].agent_sequence, 11U);
  EXPECT_EQ(queue.not_durable(), 0U);
}

TEST(SampleQueue, ABoundedNumberOfSamplesIsKeptForASlowDisk) {
  SampleQueue queue;
  queue.keep_until_durable(true);
  constexpr std::uint64_t kMore = 1000;
  for (std::uint64_t i = 1; i <= SampleQueue::kMaxNotDurable + kMore; ++i) {
    queue.push(sample(i));
    queue.take(16);
    queue.answered(i);
  }
  EXPECT_EQ(queue.given_up(), kMore - 1);
  queue.rewind(0);
  EXPECT_EQ(queue.take(1).samples[0].agent_sequence, kMore);
}

TEST(SampleQueue, FeltSamplesAreNotDroppedForNewOnes) {
  SampleQueue queue;
  queue.keep_until_durable(true);
  for (std::uint64_t i = 1; i <= 2000; ++i) {
    queue.push(sample(i));
    queue.take(16);
    queue.answered(i);
  }
  queue.rewind(0);
  // Every second sample cuts: none may be merged or thinned out.
  for (std::uint64_t i = 2001; i <= 2400 + SampleQueue::kMaxKept; ++i) {
    queue.push(sample(i, i % 2 == 0));
  }
  EXPECT_GE(queue.forgotten(), 399U);
  std::uint64_t number = 0, last_us = 0;
  for (auto batch = queue.take(16); batch.count > 0; batch = queue.take(16)) {
    for (const wire::MotionSample& sent : batch.view()) {
      EXPECT_EQ(sent.agent_sequence, ++number);
      if (number <= 2000) {
        EXPECT_EQ(sent.time_us, number);
      }
      const bool cuts = (sent.buttons & wire::kButtonCutting) != 0;
      EXPECT_TRUE(!cuts || sent.time_us <= last_us + 1) << "no chord across a gap";
      last_us = sent.time_us;
    }
    queue.answered(number);
  }
  EXPECT_TRUE(queue.settled());
}

TEST(SampleQueue, AFullQueueKeepsTheLastAnsweredSampleAndCutsNoChordFromIt) {
  SampleQueue queue;
  queue.keep_until_durable(true);
  for (std::uint64_t i = 1; i <= 10; ++i) queue.push(sample(i));
  queue.take(16);
  queue.answered(10);
  // Again none of these may be merged. The last two, together with sample 10, are too many.
  for (std::uint64_t i = 11; i <= 11 + SampleQueue::kMaxKept; ++i) {
    queue.push(sample(i, i % 2 == 0));
  }
  EXPECT_EQ(queue.forgotten(), 1U);
  queue.rewind(0);
  const auto batch = queue.take(16);
  ASSERT_EQ(batch.count, 16U);
  for (std::uint32_t i = 0; i < 10; ++i) EXPECT_EQ(batch.samples[i].time_us, i + 1);
  EXPECT_EQ(batch.samples[10].time_us, 12U);
  EXPECT_EQ(batch.samples[10].agent_sequence, 11U);
  EXPECT_EQ(batch.samples[10].buttons & wire::kButtonCutting, 0U) << "a gap lies before it";
  EXPECT_NE(batch.samples[12].buttons & wire::kButtonCutting, 0U);
}

TEST(SampleQueue, AnswersToUnsentNumbersAreIgnored) {
  SampleQueue queue;
  queue.push(sample(1));
  queue.take(16);
  queue.answered(1000);
  EXPECT_FALSE(queue.settled());
  EXPECT_EQ(queue.unanswered(), 1U);
}

TEST(SampleQueue, BacklogMergesAirMovesAndKeepsCuts) {
  SampleQueue queue;
  queue.push(sample(1, false));
  for (std::uint64_t i = 2; i <= 60; ++i) queue.push(sample(i, false));
  for (std::uint64_t i = 61; i <= 80; ++i) queue.push(sample(i, true));
  const auto sent = take_all(queue);
  ASSERT_EQ(sent.size(), 21U);
  EXPECT_EQ(sent[0].time_us, 60U) << "the start of the cut is kept";
  EXPECT_EQ(queue.merged_air(), 59U);
  EXPECT_EQ(queue.thinned_cuts(), 0U);
  for (std::size_t i = 0; i < sent.size(); ++i) EXPECT_EQ(sent[i].agent_sequence, i + 1);
}

TEST(SampleQueue, SendsWithinTheWindowOnly) {
  SampleQueue queue;
  for (std::uint64_t i = 0; i < 30; ++i) queue.push(sample(10'000 * i));
  EXPECT_EQ(take_all(queue).back().time_us, 120'000U);
  EXPECT_EQ(queue.take(16).count, 0U);
  queue.answered(5);
  EXPECT_EQ(take_all(queue).back().time_us, 170'000U);
  queue.rewind();
  EXPECT_EQ(take_all(queue).front().agent_sequence, 5U);
}

TEST(SampleQueue, BacklogMergesStraightCutsToChords) {
  SampleQueue queue;
  constexpr std::uint64_t kCorner = 40;
  for (std::uint64_t i = 0; i <= 2 * kCorner; ++i) {
    const auto along = static_cast<double>(std::min(i, kCorner));
    const auto across = static_cast<double>(i - std::min(i, kCorner));
    queue.push(
        {.time_us = i, .tip_mm = {0.1 * along, 0.1 * across, 0}, .buttons = wire::kButtonCutting});
  }
  const auto sent = take_all(queue);
  EXPECT_LT(sent.size(), 60U);
  EXPECT_GT(queue.merged_cuts(), 20U);
  EXPECT_EQ(sent.size() + queue.merged_cuts(), 2 * kCorner + 1);
  for (std::size_t i = 1; i < sent.size(); ++i) {
    EXPECT_LE(sent[i].time_us - sent[i - 1].time_us, SampleQueue::kLongestChord);
    // No chord crosses the corner.
    EXPECT_TRUE(sent[i].time_us <= kCorner || sent[i - 1].time_us >= kCorner);
  }
  EXPECT_EQ(sent.back().time_us, 2 * kCorner);
}

TEST(SampleQueue, UnevenAxisRotationIsNotMerged) {
  SampleQueue queue;
  for (std::uint64_t i = 0; i < 60; ++i) {
    const float lean = i % 2 == 0 ? 0.001F : 0.0F;
    queue.push({.time_us = i,
                .tip_mm = {0.1 * static_cast<double>(i), 0, 0},
                .axis = {lean, 0, 1},
                .buttons = wire::kButtonCutting});
  }
  EXPECT_EQ(take_all(queue).size(), 60U);
}

TEST(SampleQueue, FullQueueOfCutsIsThinnedAndStaysBounded) {
  SampleQueue queue;
  const std::uint64_t many = 4 * SampleQueue::kMaxKept;
  for (std::uint64_t i = 1; i <= many; ++i) {
    queue.push(sample(i));
    ASSERT_LE(queue.unsent(), SampleQueue::kMaxKept);
  }
  EXPECT_GT(queue.thinned_cuts(), 0U);
  EXPECT_EQ(queue.forgotten(), 0U);
  const auto first = queue.take(1);
  EXPECT_EQ(first.samples[0].time_us, 1U) << "the start of the path is kept";
  EXPECT_EQ(take_all(queue).back().time_us, many);
}

TEST(SampleQueue, OldestUnansweredSamplesAreDroppedWhenFull) {
  SampleQueue queue;
  for (std::uint64_t i = 1; i <= SampleQueue::kMaxKept + 100; ++i) {
    queue.push(sample(i));
    queue.take(1);
  }
  EXPECT_EQ(queue.forgotten(), 100U);
  queue.rewind();
  EXPECT_EQ(queue.take(16).samples[0].agent_sequence, 101U);
}

}  // namespace
}  // namespace kerf::agent::sample_queue_test
