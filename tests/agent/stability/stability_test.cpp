// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/agent/stability/experiments.h"

namespace kerf::agent {
namespace {

TEST(Stability, ModelIsStableUpTo250MsRoundTrip) {
  for (const LineQuality& line :
       {LineQuality{.rtt_ms = 0}, LineQuality{.rtt_ms = 25, .jitter = 0.2},
        LineQuality{.rtt_ms = 100, .jitter = 0.2, .loss = 0.02},
        LineQuality{.rtt_ms = 250, .bursts = true}}) {
    for (const bool copy : {true, false}) {
      const SwingOutcome outcome =
          swing({.mode = ForceMode::kModel, .line = line, .damping_n_s_per_m = 20, .copy = copy});
      EXPECT_TRUE(outcome.stable()) << line.rtt_ms << " ms: " << outcome.fastest_mm_per_s
                                    << " mm/s, " << outcome.returned_mj << " mJ";
      EXPECT_GT(outcome.max_force_n, 0.2) << "the test requires a force";
    }
  }
}

TEST(Stability, WithAReplicaTheForceIsAccurateAtAnyDelay) {
  const Recording recording = record_carving(4);
  EXPECT_LT(force_error(recording, ForceMode::kModel, {.rtt_ms = 0}, true), 0.05);
  EXPECT_LT(force_error(recording, ForceMode::kModel, {.rtt_ms = 25}, true), 0.05);
  EXPECT_LT(force_error(recording, ForceMode::kModel, {.rtt_ms = 100}, true), 0.05);
  const LineQuality poor{.rtt_ms = 100, .jitter = 0.2, .loss = 0.02};
  EXPECT_LT(force_error(recording, ForceMode::kModel, poor, true), 0.1);
}

TEST(Stability, ModelIsMoreAccurateThanHoldAndInterpolation) {
  const Recording recording = record_carving(4);
  const LineQuality line{.rtt_ms = 25};
  const double model = force_error(recording, ForceMode::kModel, line, false);
  EXPECT_LT(model, 0.15);
  EXPECT_LT(model, 0.6 * force_error(recording, ForceMode::kHold, line, false));
  EXPECT_LT(model, 0.6 * force_error(recording, ForceMode::kInterpolated, line, false));
}

}  // namespace
}  // namespace kerf::agent
