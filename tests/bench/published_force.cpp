// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/published_force.h"

#include <cmath>
#include <cstdio>
#include <functional>

#include "tests/kernel/force/published_slots.h"

namespace kerf::bench {
namespace {

using Coefficients = std::function<MillingSettings(std::size_t)>;

void print_row(const test::PublishedSlots& slots, const char* source, const Coefficients& of) {
  std::printf("%-24s %-22s", slots.name.c_str(), source);
  for (std::size_t n = 0; n < slots.means.size(); ++n) {
    const test::SlotError error = test::slot_error(slots, slots.means[n], of(n));
    std::printf(" %5.1f (%4.1f)", 100 * std::abs(error.length), 100 * error.vector);
  }
  std::printf("\n");
}

}  // namespace

void print_published_forces() {
  std::printf(
      "\nMean forces in slots against published recordings (tests/kernel/force/published_slots.h), "
      "mechanistic law, three fields: error of the resultant and, in brackets, of the force as a "
      "vector, %% of the measured resultant; ball and bull nose at 1 to 5 mm of depth, flat at "
      "0.025 to 0.125 mm per tooth.\n");
  const auto ball = test::published_ball(), bull_nose = test::published_bull_nose();
  for (const auto& slots : {bull_nose, ball, test::published_flat()}) {
    print_row(slots, "of the series", [&](std::size_t) { return test::fitted_to_all(slots); });
    print_row(slots, "each from the others",
              [&](std::size_t n) { return test::fitted_to_the_others(slots, n); });
  }
  for (const auto& slots : {bull_nose, ball}) {
    print_row(slots, "of another source",
              [](std::size_t) { return test::coefficients_of_another_source(); });
  }
}

}  // namespace kerf::bench
