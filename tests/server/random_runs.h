// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/test.h"

namespace kerf {

/// Returns a number from the environment.
inline unsigned setting(const char* name, unsigned otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : static_cast<unsigned>(std::atoi(text));
}

/// The runs of a random test. The environment can change their seed, number and length.
struct RandomRuns {
  unsigned first_seed;  ///< KERF_SEED; gtest's --gtest_repeat does not change it
  unsigned count;       ///< KERF_EFFORT
  int rounds;           ///< KERF_ROUNDS: length of a run; its cost is quadratic

  /// Calls run(seed, rounds) for each run until the test has failed.
  template <typename Run>
  void each(Run run) const {
    const unsigned first = setting("KERF_SEED", first_seed);
    const unsigned end = first + setting("KERF_EFFORT", count);
    const auto length = static_cast<int>(setting("KERF_ROUNDS", static_cast<unsigned>(rounds)));
    for (unsigned seed = first; seed < end && !::testing::Test::HasFailure(); ++seed) {
      run(seed, length);
    }
  }
};

}  // namespace kerf
