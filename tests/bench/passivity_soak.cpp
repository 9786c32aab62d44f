// SPDX-License-Identifier: Apache-2.0
// Checks the bound of the agent's passivity layer with random adversarial traces of two seconds:
//
//   passivity_soak [TRACES]        default 100000
//
// Prints the greatest energy delivered to the user over any interval of any trace, compared with
// the tank, and the result of the same traces if deficits are forgiven. Fails if the tank is
// exceeded.
#include <cstdio>
#include <cstdlib>

#include "tests/agent/servo/adversary.h"

int main(int argc, char** argv) {
  using namespace kerf::agent;
  constexpr int kTicks = 2000;
  const auto traces = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 100'000);
  const WorstReturn carried = worst_return<CarryDeficit>(0, traces, kTicks);
  const WorstReturn forgiven = worst_return<ForgiveDeficit>(0, traces / 100 + 1, kTicks);
  const double tank_mj = PassivitySettings{}.tank_mj;
  std::printf("%u traces of %d ticks: at most %.2f mJ returned over any interval (seed %u), ",
              traces, kTicks, carried.returned_mj, carried.seed);
  std::printf("tank %.0f mJ, limits %s\n", tank_mj, carried.kept_limits ? "kept" : "BROKEN");
  std::printf("deficit forgiven instead of carried: %.0f mJ (seed %u)\n", forgiven.returned_mj,
              forgiven.seed);
  return carried.kept_limits && carried.returned_mj <= tank_mj ? 0 : 1;
}
