// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/light_cut.h"

#include <algorithm>
#include <cstdio>

#include "kernel/force/ripple.h"
#include "tests/support/side_cut.h"

namespace kerf::bench {

void print_light_cuts(double pitch_mm) {
  constexpr double kRadialMm[] = {0.1, 0.2, 0.3, 0.5, 1, 2, 3, 4, 6};
  std::printf(
      "\nSide cuts, flat mills, 2.03 mm deep, pitch %.3g mm: ripple of the force, rms / mean in "
      "%%, "
      "worst of seven feed directions, by radial engagement (mm). steady: engagement from which on "
      "5 %% are promised.\n%-9s %8s %8s",
      pitch_mm, "rays", "diameter", "steady");
  for (const double radial : kRadialMm) std::printf(" %6.1f", radial);
  std::printf("\n");
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const double diameter : {6.0, 12.0}) {
      std::printf("%-9s %8.0f %8.2f", to_string(rays), diameter,
                  steady_radial_mm(rays == Rays::kDexel ? 1 : 3, pitch_mm, diameter));
      for (const double radial : kRadialMm) {
        double worst = 0;
        for (const double degrees : test::kSideCutDegrees) {
          worst = std::max(worst, test::side_cut_ripple({.radial_mm = radial,
                                                         .diameter_mm = diameter,
                                                         .pitch_mm = pitch_mm,
                                                         .degrees = degrees,
                                                         .rays = rays}));
        }
        std::printf(" %6.1f", 100 * worst);
      }
      std::printf("\n");
    }
  }
}

}  // namespace kerf::bench
