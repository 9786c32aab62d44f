// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/step_tracker.h"

#include "tests/support/test.h"

namespace kerf::agent::step_tracker_test {
namespace {

constexpr double kTickS = 0.001;

double rounded(double value, double quantum) { return quantum * std::round(value / quantum); }

struct Errors {
  double worst = 0, rate = 0;  ///< greatest errors of the estimate and of its rate
};

/// Follows a coordinate that moves evenly, and returns the errors after `settle_s`.
Errors even_motion(double mm_per_s, double quantum, bool declared, double settle_s) {
  StepTracker tracker(declared ? quantum : 0);
  Errors errors;
  const int ticks = static_cast<int>((settle_s + 10 * quantum / mm_per_s + 0.2) / kTickS);
  for (int i = 0; i < ticks; ++i) {
    const double true_mm = 0.0123 + mm_per_s * i * kTickS;
    const double estimate = tracker.take(rounded(true_mm, quantum), kTickS);
    if (i * kTickS < settle_s) continue;
    errors.worst = std::max(errors.worst, std::abs(estimate - true_mm));
    errors.rate = std::max(errors.rate, std::abs(tracker.rate() - mm_per_s));
  }
  return errors;
}

TEST(StepTracker, EvenMotionIsFollowedWithoutDelayAfterTwoSteps) {
  for (const double quantum : {0.01, 0.023, 0.055}) {
    for (const double mm_per_s : {1.0, 2.0, 5.0, 10.0, 20.0, 40.0}) {
      const double settle_s = std::max(2 * quantum / mm_per_s, 0.01) + 0.012;
      const Errors errors = even_motion(mm_per_s, quantum, true, settle_s);
      // A step is timed to within half a tick.
      EXPECT_LE(errors.worst, 0.02 * quantum + 0.5 * kTickS * mm_per_s)
          << quantum << ' ' << mm_per_s;
    }
  }
}

TEST(StepTracker, UnstatedQuantumIsFoundFromTheSteps) {
  for (const double mm_per_s : {1.0, 5.0, 20.0}) {
    const double quantum = 0.055;
    const double settle_s = (StepTracker::kStepsOfEncoder + 2) * quantum / mm_per_s + 0.03;
    const Errors errors = even_motion(mm_per_s, quantum, false, settle_s);
    EXPECT_LE(errors.worst, 0.02 * quantum + 0.5 * kTickS * mm_per_s) << mm_per_s;
  }
}

TEST(StepTracker, ContinuousValuesPassUnchanged) {
  StepTracker tracker(0);
  for (int i = 0; i < 3000; ++i) {
    const double value = 3 * std::sin(0.01 * i) + 0.02 * i;
    EXPECT_EQ(tracker.take(value, kTickS), value);
  }
  EXPECT_EQ(tracker.quantum(), 0);
}

TEST(StepTracker, StoppedContinuousDeviceIsNoEncoder) {
  StepTracker tracker(0);
  double value = 0;
  for (int i = 0; i < 4000; ++i) {
    if (i % 400 < 200) value += 0.01;  // starts and stops abruptly, every 0.4 s
    EXPECT_EQ(tracker.take(value, kTickS), value);
  }
}

TEST(StepTracker, RepeatedReadIsNoRest) {
  // A device measures 900 times per second and is read 1000 times.
  StepTracker tracker(0);
  double measured = 0;
  for (int i = 0; i < 4000; ++i) {
    const bool is_new = i % 10 != 0;
    if (is_new) measured += 0.02 + 0.001 * std::sin(0.01 * i);
    EXPECT_EQ(tracker.take(measured, kTickS, is_new), measured);
  }
  EXPECT_EQ(tracker.quantum(), 0);
}

TEST(StepTracker, TheEstimateStaysInTheCellOfTheMeasuredValue) {
  constexpr double kQuantum = 0.05;
  std::mt19937 random(3);
  std::normal_distribution<double> push(0, 40);
  StepTracker tracker(kQuantum);
  double at = 0, velocity = 0;
  for (int i = 0; i < 20'000; ++i) {
    velocity += (push(random) - 8 * velocity - 60 * at) * kTickS * 10;
    at += velocity * kTickS;
    const double measured = rounded(at, kQuantum);
    const double estimate = tracker.take(measured, kTickS);
    EXPECT_LE(std::abs(estimate - measured), kQuantum / 2 + 1e-12);
    EXPECT_LE(std::abs(estimate - at), kQuantum + 1e-12);
  }
}

TEST(StepTracker, FlickeringValueRestsBetweenItsSteps) {
  constexpr double kQuantum = 0.05;
  StepTracker tracker(kQuantum);
  double estimate = 0;
  for (int i = 0; i < 500; ++i) estimate = tracker.take(i / 7 % 2 == 0 ? 0 : kQuantum, kTickS);
  EXPECT_NEAR(estimate, kQuantum / 2, 1e-3);
  EXPECT_NEAR(tracker.rate(), 0, 0.5);
}

TEST(StepTracker, AStopIsReachedWithinTheCell) {
  constexpr double kQuantum = 0.05;
  StepTracker tracker(kQuantum);
  double estimate = 0;
  for (int i = 0; i < 1000; ++i) {
    const double at = std::min(i, 500) * kTickS * 4;
    estimate = tracker.take(rounded(at, kQuantum), kTickS);
  }
  EXPECT_NEAR(estimate, 2, kQuantum / 2 + 1e-9);
  EXPECT_EQ(tracker.rate(), 0) << "it rests";
}

TEST(StepTracker, AReversalIsSeenAtTheSameStep) {
  constexpr double kQuantum = 0.05;
  StepTracker tracker(kQuantum);
  constexpr int kTicks = 4000;
  double worst = 0, squares = 0;
  for (int i = 0; i < kTicks; ++i) {
    const double at = 1.5 * std::sin(2 * std::numbers::pi * 0.5 * i * kTickS);
    const double off = std::abs(tracker.take(rounded(at, kQuantum), kTickS) - at);
    worst = std::max(worst, off);
    squares += off * off;
  }
  EXPECT_LE(worst, kQuantum);
  EXPECT_LE(std::sqrt(squares / kTicks), 0.26 * kQuantum) << "rounding alone leaves 0.29";
}

}  // namespace
}  // namespace kerf::agent::step_tracker_test
