// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace kerf::agent {

/// A deficit stays until it has been worked off. This one line makes the promise of passivity true.
struct CarryDeficit {
  static constexpr double keep(double level_mj) noexcept { return level_mj; }
};

/// What the servo may still give to the hand, mJ: it is filled by what the hand works into the
/// device, up to a ceiling, and emptied by what the device works into the hand. `Deficit` says what
/// becomes of a level below zero; the agent carries it, and a test shows that nothing less will do.
template <typename Deficit = CarryDeficit>
class BasicEnergyAccount {
 public:
  explicit BasicEnergyAccount(double ceiling_mj) noexcept : ceiling_mj_(ceiling_mj) {}

  /// So much has been worked into the hand (below zero: by the hand), exactly.
  void settle(double work_mj) noexcept {
    level_mj_ = Deficit::keep(std::min(ceiling_mj_, level_mj_ - work_mj));
    given_mj_ += work_mj;
    least_given_mj_ = std::min(least_given_mj_, given_mj_);
    most_returned_mj_ = std::max(most_returned_mj_, given_mj_ - least_given_mj_);
  }

  double level_mj() const noexcept { return level_mj_; }
  double ceiling_mj() const noexcept { return ceiling_mj_; }
  /// The net work into the hand since the start: an observer that the level has no part in.
  double given_mj() const noexcept { return given_mj_; }
  /// The most that was given over any interval so far.
  double most_returned_mj() const noexcept { return most_returned_mj_; }

 private:
  double ceiling_mj_;
  double level_mj_ = 0;
  double given_mj_ = 0;
  double least_given_mj_ = 0;
  double most_returned_mj_ = 0;
};

}  // namespace kerf::agent
