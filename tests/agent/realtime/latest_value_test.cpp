// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/realtime/latest_value.h"

#include "haptic_agent/servo/sample_ring.h"
#include "tests/support/test.h"

namespace kerf::agent::latest_value_test {
namespace {

struct Triple {
  std::uint64_t a = 0;
  std::uint64_t b = 0;
  std::uint64_t c = 0;
};

TEST(LatestValue, ReturnsTheNewestValueOnce) {
  LatestValue<int> value;
  int got = -1;
  EXPECT_FALSE(value.read(got));
  EXPECT_EQ(got, -1);
  value.write(1);
  value.write(2);
  EXPECT_TRUE(value.read(got));
  EXPECT_EQ(got, 2);
  EXPECT_FALSE(value.read(got));
  value.write(3);
  EXPECT_TRUE(value.read(got));
  EXPECT_EQ(got, 3);
}

TEST(LatestValue, ValuesAreConsistentAndInOrder) {
  LatestValue<Triple> value;
  constexpr std::uint64_t kLast = 200'000;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kLast; ++i) value.write({i, 2 * i, 3 * i});
  });
  Triple got;
  std::uint64_t before = 0;
  bool whole = true;
  while (got.a != kLast) {
    if (!value.read(got)) continue;
    whole = whole && got.b == 2 * got.a && got.c == 3 * got.a && got.a > before;
    before = got.a;
  }
  writer.join();
  EXPECT_TRUE(whole);
}

TEST(SampleRing, RejectsValuesWhenFullAndKeepsTheOrder) {
  SampleRing ring;
  wire::MotionSample sample;
  EXPECT_FALSE(ring.pop(sample));
  for (std::size_t i = 0; i < SampleRing::kCapacity; ++i) {
    sample.time_us = i;
    ASSERT_TRUE(ring.push(sample));
  }
  EXPECT_FALSE(ring.push(sample));
  for (std::size_t i = 0; i < SampleRing::kCapacity; ++i) {
    ASSERT_TRUE(ring.pop(sample));
    ASSERT_EQ(sample.time_us, i);
  }
  EXPECT_FALSE(ring.pop(sample));
}

TEST(SampleRing, TransfersEverySampleBetweenThreads) {
  SampleRing ring;
  constexpr std::uint64_t kLast = 100'000;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kLast;) {
      if (ring.push({.time_us = i})) ++i;
    }
  });
  wire::MotionSample sample;
  std::uint64_t expected = 1;
  while (expected <= kLast) {
    if (!ring.pop(sample)) continue;
    ASSERT_EQ(sample.time_us, expected);
    ++expected;
  }
  writer.join();
}

}  // namespace
}  // namespace kerf::agent::latest_value_test
