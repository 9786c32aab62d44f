// SPDX-License-Identifier: Apache-2.0
#include "kernel/math/series_lanes.h"

#include "tests/support/test.h"

namespace kerf::series_lanes_test {
namespace {

TEST(SeriesLanes, PowersAgreeWithTheLibrary) {
  for (double base = 1e-9; base < 1e9; base *= 1.37) {
    Lanes bases;
    for (int i = 0; i < kLanes; ++i) bases.set(i, base * (1 + 0.04 * i));
    for (const double exponent : {-0.9, -0.5, -0.24, 0.0, 0.3, 1.0}) {
      const Lanes got = power(bases, exponent);
      for (int i = 0; i < kLanes; ++i) {
        const double wanted = std::pow(bases[i], exponent);
        EXPECT_NEAR(got[i] / wanted, 1, 1e-13) << bases[i] << "^" << exponent;
      }
    }
  }
}

TEST(SeriesLanes, PhasesAgreeWithTheLibraryForAnyNumberOfTurns) {
  for (double turns = -3.2; turns < 3.2; turns += 0.0137) {
    Lanes all;
    for (int i = 0; i < kLanes; ++i) all.set(i, turns + 0.0011 * i);
    const PhaseLanes got = phase_of_turns(all);
    for (int i = 0; i < kLanes; ++i) {
      EXPECT_NEAR(got.cosine[i], std::cos(2 * M_PI * all[i]), 1e-14) << all[i];
      EXPECT_NEAR(got.sine[i], std::sin(2 * M_PI * all[i]), 1e-14) << all[i];
    }
  }
}

TEST(SeriesLanes, RaisedPhasesAreThoseOfMultiples) {
  const PhaseLanes base = phase_of_turns(Lanes(0.137));
  for (const int n : {1, 2, 3, 7, 300}) {
    EXPECT_NEAR(raised(base, n).cosine[3], std::cos(2 * M_PI * 0.137 * n), 1e-12) << n;
    EXPECT_NEAR(raised(base, n).sine[3], std::sin(2 * M_PI * 0.137 * n), 1e-12) << n;
  }
}

}  // namespace
}  // namespace kerf::series_lanes_test
