// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace kerf::agent {

/// Keeps a deficit until it is dissipated. The proof of passivity depends on this line.
struct CarryDeficit {
  static constexpr double keep(double level_mj) noexcept { return level_mj; }
};

/// Energy tank: the work that the device may still do on the user, mJ. Work of the user on the
/// device fills it, up to a ceiling; work of the device on the user empties it. `Deficit` handles a
/// negative level: the agent carries it, and a test shows that forgiving it breaks passivity.
template <typename Deficit = CarryDeficit>
class BasicEnergyAccount {
 public:
  /// The account begins at `level_mj`, limited to the ceiling.
  explicit BasicEnergyAccount(double ceiling_mj, double level_mj = 0) noexcept
      : ceiling_mj_(ceiling_mj), level_mj_(std::min(level_mj, ceiling_mj)) {}

  /// Accounts for work done on the user (negative: by the user).
  void settle(double work_mj) noexcept {
    level_mj_ = Deficit::keep(std::min(ceiling_mj_, level_mj_ - work_mj));
    given_mj_ += work_mj;
    least_given_mj_ = std::min(least_given_mj_, given_mj_);
    most_returned_mj_ = std::max(most_returned_mj_, given_mj_ - least_given_mj_);
  }

  double level_mj() const noexcept { return level_mj_; }
  double ceiling_mj() const noexcept { return ceiling_mj_; }
  /// Net work done on the user since the start. Only observes: the level is not clamped here.
  double given_mj() const noexcept { return given_mj_; }
  /// Maximum of the work done on the user over any interval so far.
  double most_returned_mj() const noexcept { return most_returned_mj_; }

 private:
  double ceiling_mj_;
  double level_mj_;
  double given_mj_ = 0;
  double least_given_mj_ = 0;
  double most_returned_mj_ = 0;
};

}  // namespace kerf::agent
