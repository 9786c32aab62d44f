// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/study/trial_run.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "haptic_agent/device/units.h"

namespace kerf::agent {
namespace {

const char* name_of(ForceMode mode) { return mode == ForceMode::kModel ? "kerf" : "paper"; }

bool has_force(const TickRecord& tick) noexcept {
  return tick.has_pose &&
         (tick.phase == ServoPhase::kActive || tick.phase == ServoPhase::kDegraded);
}

}  // namespace

TrialRun::TrialRun(const TrialSettings& settings) : settings_(settings), random_(settings.seed) {
  draw();
}

void TrialRun::draw() {
  // The standard defines the generator's sequence, so the order is the same on every machine.
  const bool kerf_first = (random_() >> 63U) != 0;
  const int trial = current_.trial + 1;
  current_ = {.trial = trial};
  current_.intervals[0].mode = kerf_first ? ForceMode::kModel : ForceMode::kPaper;
  current_.intervals[1].mode = kerf_first ? ForceMode::kPaper : ForceMode::kModel;
}

ForceMode TrialRun::mode() const noexcept {
  if (state_ == State::kA) return current_.intervals[0].mode;
  if (state_ == State::kB) return current_.intervals[1].mode;
  return ForceMode::kSilent;
}

void TrialRun::enter(State state) noexcept {
  state_ = state;
  ticks_ = 0;
  if (state == State::kQuestion) asked_us_ = now_us_;
}

void TrialRun::take(const TickRecord& tick) noexcept {
  now_us_ = tick.time_us;
  if (!has_force(tick)) return;
  switch (state_) {
    case State::kBefore:
    case State::kBetween:
      if (++ticks_ >= kPauseTicks) enter(state_ == State::kBefore ? State::kA : State::kB);
      return;
    case State::kA:
    case State::kB: {
      // The servo applies a change of the mode some ticks later.
      if (tick.mode != mode()) return;
      Interval& interval = current_.intervals[state_ == State::kA ? 0 : 1];
      interval.felt.add(tick.felt, tick.computed, tick.felt_share);
      if (++ticks_ >= settings_.interval_ticks) {
        enter(state_ == State::kA ? State::kBetween : State::kQuestion);
      }
      return;
    }
    case State::kQuestion:
    case State::kDone:
      return;
  }
}

std::optional<TrialResult> TrialRun::answer(int interval, std::uint64_t now_us) {
  if (state_ != State::kQuestion) return std::nullopt;
  current_.answer = interval;
  current_.reaction_s = now_us > asked_us_ ? static_cast<double>(now_us - asked_us_) * kSPerUs : 0;
  const TrialResult result = current_;
  const bool last = current_.trial >= settings_.trials;
  enter(last ? State::kDone : State::kBefore);
  if (!last) draw();
  return result;
}

std::string study_header() {
  return "trial,seed,order,mode_a,mode_b,answer,correct,reaction_s,rms_difference_a,"
         "rms_difference_b,felt_mean_a_n,felt_mean_b_n,cut_ticks_a,cut_ticks_b\n";
}

std::string study_line(const TrialResult& result, std::uint64_t seed) {
  const auto& [a, b] = result.intervals;
  std::ostringstream out;
  out << result.trial << ',' << seed << ',' << name_of(a.mode) << '-' << name_of(b.mode) << ','
      << name_of(a.mode) << ',' << name_of(b.mode) << ',' << (result.answer == 0 ? 'A' : 'B') << ','
      << (result.correct() ? 1 : 0) << ',' << result.reaction_s << ',' << a.felt.force.error()
      << ',' << b.felt.force.error() << ',' << a.felt.force.felt_mean() << ','
      << b.felt.force.felt_mean() << ',' << a.felt.ticks << ',' << b.felt.ticks << '\n';
  return out.str();
}

double chance_of(int correct, int trials) {
  constexpr double kHalf = 0.5;
  double sum = 0;
  for (int k = correct; k <= trials; ++k) {
    sum += std::exp(std::lgamma(trials + 1.0) - std::lgamma(k + 1.0) -
                    std::lgamma(trials - k + 1.0) + trials * std::log(kHalf));
  }
  return std::min(1.0, sum);
}

}  // namespace kerf::agent
