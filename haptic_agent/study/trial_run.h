// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <string>

#include "haptic_agent/servo/felt.h"
#include "haptic_agent/servo/tick_tape.h"

namespace kerf::agent {

struct TrialSettings {
  int trials = 20;
  std::uint64_t seed = 1;
  /// Length of an interval: ticks in which a force is permitted.
  std::uint64_t interval_ticks = 5000;
};

/// One of the two intervals of a trial.
struct Interval {
  ForceMode mode = ForceMode::kModel;
  /// Felt and computed wrench, over the ticks with a computed force.
  FeltReport felt{};
};

/// An answered trial.
struct TrialResult {
  int trial = 0;  ///< from 1
  std::array<Interval, 2> intervals{};
  int answer = 0;  ///< the chosen interval, 0 or 1
  /// Time from the end of the second interval to the answer.
  double reaction_s = 0;
  /// The chosen interval is that of ForceMode::kModel.
  bool correct() const noexcept {
    return intervals[static_cast<std::size_t>(answer)].mode == ForceMode::kModel;
  }
};

/// A two-alternative forced choice between the paper's loop and Kerf's. In each trial the user cuts
/// during two intervals, A and B, one with ForceMode::kPaper and one with kModel, in random order,
/// and then chooses one. Between them and during the question the session gives no force. A pure
/// function of the ticks, the answers and the seed.
class TrialRun {
 public:
  enum class State : std::uint8_t { kBefore, kA, kBetween, kB, kQuestion, kDone };

  explicit TrialRun(const TrialSettings& settings);

  /// Processes the next tick of the servo.
  void take(const TickRecord& tick) noexcept;
  /// Records the answer, 0 for interval A and 1 for B, given at `now_us` on the servo's clock.
  /// Returns the result, or nullopt if no question was open.
  std::optional<TrialResult> answer(int interval, std::uint64_t now_us);

  State state() const noexcept { return state_; }
  /// Mode in which the servo must render now.
  ForceMode mode() const noexcept;
  int trial() const noexcept { return current_.trial; }

  /// Time without force before an interval, in ticks.
  static constexpr std::uint64_t kPauseTicks = 500;

 private:
  void enter(State state) noexcept;
  void draw();

  TrialSettings settings_;
  std::mt19937_64 random_;
  State state_ = State::kBefore;
  TrialResult current_;
  std::uint64_t ticks_ = 0;     ///< counted in this state
  std::uint64_t now_us_ = 0;    ///< time of the newest tick
  std::uint64_t asked_us_ = 0;  ///< time of the question
};

/// Header and lines of the table of a study.
std::string study_header();
std::string study_line(const TrialResult& result, std::uint64_t seed);

/// Returns the probability that at least `correct` of `trials` answers are correct by chance alone.
double chance_of(int correct, int trials);

}  // namespace kerf::agent
