// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/servo/supervisor.h"
#include "tests/support/test.h"

namespace kerf::agent {

/// A supervisor of a device with a workspace and ratings, on a simulated clock.
class SupervisorTest : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kMs = 1000;

  /// Runs `ms` ticks. Returns the last gain.
  double pass(int ms) {
    double share = 0;
    for (int i = 0; i < ms; ++i) {
      in.now_us += kMs;
      share = supervisor.tick(in);
    }
    return share;
  }
  /// Runs `ms` ticks and expects kReady in each.
  void expect_ready(int ms) {
    for (int i = 0; i < ms; ++i) {
      pass(1);
      ASSERT_EQ(supervisor.phase(), ServoPhase::kReady) << i;
    }
  }
  void arm() {
    pass(700);
    ASSERT_EQ(supervisor.phase(), ServoPhase::kActive);
  }
  void expect_trip(TripCode code) {
    EXPECT_EQ(pass(1), 0) << "at once";
    EXPECT_EQ(supervisor.phase(), ServoPhase::kSafe);
    EXPECT_EQ(to_string(supervisor.code()), to_string(code));
    EXPECT_EQ(supervisor.trips(), 1U);
  }

  SafetyLimits limits{.continuous_force_n = 2,
                      .continuous_torque_nmm = 100,
                      .workspace_min_mm = {-100, -100, -100},
                      .workspace_max_mm = {100, 100, 100}};
  Supervisor supervisor{limits};
  SafetyInput in{.now_us = 1'000'000, .deadman = true, .has_answer = true};
};

}  // namespace kerf::agent
