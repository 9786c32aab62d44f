// SPDX-License-Identifier: Apache-2.0
#include "kernel/math/int_lanes.h"

#include "tests/support/test.h"

namespace kerf::int_lanes_test {
namespace {

using Ints = std::array<std::int32_t, kLanes>;
constexpr std::int32_t kMin = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kMax = std::numeric_limits<std::int32_t>::max();

Ints random_ints(std::mt19937& random) {
  std::uniform_int_distribution<std::int32_t> any_value(kMin, kMax);
  std::uniform_int_distribution<std::int32_t> small(-2, 2);
  Ints v;
  for (std::int32_t& x : v) x = random() % 2 == 0 ? any_value(random) : small(random);
  return v;
}

Ints stored(IntLanes v) {
  Ints out;
  store_ints(out.data(), v);
  return out;
}

TEST(IntLanes, LoadAndStoreWorkAtAnyAlignment) {
  alignas(32) std::int32_t from[kLanes + 1] = {9, 1, -2, 3, -4, 5, -6, kMin, kMax};
  std::int32_t to[kLanes + 1] = {};
  store_ints(to + 1, load_ints(from + 1));
  for (int i = 1; i <= kLanes; ++i) EXPECT_EQ(to[i], from[i]);
  EXPECT_EQ(to[0], 0);
}

TEST(IntLanes, EveryOperationMatchesPlainIntegers) {
  std::mt19937 random(7);
  for (int n = 0; n < 10000; ++n) {
    const Ints a = random_ints(random), b = random_ints(random);
    const IntLanes x = load_ints(a.data()), y = load_ints(b.data());
    const Ints most = stored(greater(x, y)), least = stored(lesser(x, y));
    const Lanes as_double = to_lanes(x);
    const Ints back = stored(to_int_lanes(as_double));
    const LongLanes sums = sum_of_halves(x);
    unsigned mask = 0;
    for (int i = 0; i < kLanes; ++i) {
      const auto k = std::size_t(i);
      ASSERT_EQ(most[k], std::max(a[k], b[k]));
      ASSERT_EQ(least[k], std::min(a[k], b[k]));
      ASSERT_EQ(as_double[i], double(a[k]));
      ASSERT_EQ(back[k], a[k]);
      if (i < 4) {
        ASSERT_EQ(sums[i], std::int64_t{a[k]} + a[k + 4]);
      }
      if (a[k] < b[k]) mask |= 1U << i;
    }
    const Ints chosen = stored(select(less(x, y), x, y));
    ASSERT_EQ(chosen, least);
    ASSERT_EQ(bits(less(x, y)), mask);
    ASSERT_EQ(any(less(x, y)), mask != 0);
  }
}

TEST(IntLanes, ConversionFromDoublesRoundsTowardsZero) {
  Lanes v;
  const double values[kLanes] = {0.0, 0.999, -0.999, 1.5, -1.5, 2147483647.0, -2147483648.0, 7.0};
  for (int i = 0; i < kLanes; ++i) v.set(i, values[i]);
  EXPECT_EQ(stored(to_int_lanes(v)), (Ints{0, 0, 0, 1, -1, kMax, kMin, 7}));
}

TEST(IntLanes, EachLaneHasItsOwnBit) {
  for (int i = 0; i < kLanes; ++i) {
    EXPECT_EQ(stored(lane_bits())[std::size_t(i)], 1 << i);
    EXPECT_EQ(lane_numbers()[i], i);
    Ints one{};
    one[std::size_t(i)] = -1;
    const IntMask mask = equal(load_ints(one.data()), IntLanes{} - 1);
    EXPECT_EQ(bits(mask), 1U << i);
    EXPECT_TRUE(any(mask));
  }
  EXPECT_FALSE(any(less(IntLanes{}, IntLanes{})));
}

}  // namespace
}  // namespace kerf::int_lanes_test
