// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/realtime/histogram.h"

#include "tests/support/test.h"

namespace kerf::agent::histogram_test {
namespace {

TEST(Histogram, IsInitiallyEmpty) {
  const Histogram histogram;
  EXPECT_EQ(histogram.quantile_us(0.5), 0U);
  EXPECT_EQ(histogram.total(), 0U);
}

TEST(Histogram, SmallValuesAreExact) {
  Histogram histogram;
  for (std::uint64_t i = 1; i <= 16; ++i) histogram.add(i);
  EXPECT_EQ(histogram.quantile_us(0.5), 8U);
  EXPECT_EQ(histogram.quantile_us(1.0), 16U);
}

TEST(Histogram, LargeValuesAreWithinASixteenth) {
  for (const std::uint64_t value : {100ULL, 999ULL, 12'345ULL, 1'000'003ULL, 4'000'000'000ULL}) {
    Histogram histogram;
    histogram.add(value);
    histogram.add(5'000'000'000ULL);
    const auto quantile = static_cast<double>(histogram.quantile_us(0.5));
    EXPECT_GE(quantile, static_cast<double>(value));
    EXPECT_LE(quantile, static_cast<double>(value) * (1 + 1.0 / 16));
  }
}

TEST(Histogram, ValuesBeyondTheRangeCountAsTheLargest) {
  Histogram histogram;
  histogram.add(std::uint64_t{1} << 60);
  EXPECT_EQ(histogram.total(), 1U);
  EXPECT_EQ(histogram.max_us(), std::uint64_t{1} << 60);
}

TEST(Histogram, TailQuantilesAreExact) {
  Histogram histogram;
  for (int i = 0; i < 999; ++i) histogram.add(10);
  histogram.add(5000);
  EXPECT_EQ(histogram.quantile_us(0.99), 10U);
  EXPECT_EQ(histogram.quantile_us(0.9995), 5000U);
}

}  // namespace
}  // namespace kerf::agent::histogram_test
