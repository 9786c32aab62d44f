// SPDX-License-Identifier: Apache-2.0
// The mechanistic law compared with published recordings (published_slots.h).
#include "tests/kernel/force/published_slots.h"
#include "tests/support/test.h"

namespace kerf::milling_published_test {
namespace {

/// Greatest errors of a mean in percent.
struct Percent {
  double length, vector;
};

void expect_within(const test::PublishedSlots& slots, std::size_t n, const Percent& most,
                   const MillingSettings& milling) {
  const test::SlotMean& mean = slots.means[n];
  const test::SlotError error = test::slot_error(slots, mean, milling);
  const std::string which = slots.name + ", " + std::to_string(mean.depth_mm) + " mm deep, " +
                            std::to_string(mean.feed_per_tooth_mm) + " mm per tooth";
  EXPECT_LT(std::abs(error.length), most.length / 100) << which;
  EXPECT_LT(error.vector, most.vector / 100) << which;
}

void expect_of_another_source(const test::PublishedSlots& slots, const Percent (&most)[5]) {
  for (std::size_t n = 0; n < 5; ++n) {
    expect_within(slots, n, most[n], test::coefficients_of_another_source());
  }
}

TEST(MillingPublished, SlotsWithCoefficientsOfAnotherSource) {
  // At 1 mm the bottom cuts most, where the coefficients of a side do not apply.
  expect_of_another_source(test::published_bull_nose(),
                           {{23, 25}, {9, 12}, {5, 9}, {7, 12}, {8, 13}});
  expect_of_another_source(test::published_ball(), {{20, 21}, {9, 10}, {3, 6}, {8, 9}, {10, 12}});
}

TEST(MillingPublished, EachSlotWithCoefficientsOfItsSeries) {
  for (const test::PublishedSlots& slots :
       {test::published_bull_nose(), test::published_ball(), test::published_flat()}) {
    for (std::size_t n = 0; n < slots.means.size(); ++n)
      expect_within(slots, n, {5, 6}, test::fitted_to_all(slots));
  }
}

/// Expects each mean within its errors, with the coefficients that fit the remaining means best.
void expect_each_from_the_others(const test::PublishedSlots& slots, const Percent (&most)[5]) {
  for (std::size_t n = 0; n < 5; ++n) {
    expect_within(slots, n, most[n], test::fitted_to_the_others(slots, n));
  }
}

TEST(MillingPublished, EachSlotIsPredictedFromTheOtherSlots) {
  // The directions are less exact where a point is outside the range of the remaining ones.
  expect_each_from_the_others(test::published_bull_nose(),
                              {{10, 12}, {10, 10}, {10, 10}, {10, 10}, {10, 10}});
  expect_each_from_the_others(test::published_ball(),
                              {{10, 10}, {10, 10}, {10, 10}, {10, 10}, {10, 10}});
  expect_each_from_the_others(test::published_flat(),
                              {{10, 15}, {10, 10}, {10, 10}, {10, 10}, {10, 10}});
}

}  // namespace
}  // namespace kerf::milling_published_test
