// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace kerf::agent {

/// The ticks that the loop lost in the last second, and the resulting factor of the force. A force
/// that follows the pose a tick later acts like a delayed spring, which is stable up to a stiffness
/// that falls as 1 / delay (`stable_gains`). At a random time the loop is in a tick of mean length
/// T = Σ dt² / Σ dt instead of 1 ms, so every force is multiplied by 1 ms / T.
class LostTicks {
 public:
  /// `lost`: ticks lost since the previous one; `dt_s`: length of this one.
  void note(std::uint64_t now_us, std::uint64_t lost, double dt_s) noexcept {
    const std::uint64_t slot = now_us / kSlotUs;
    if (slot - slot_ > slots_.size()) {
      clear();
      slot_ = slot;
    }
    while (slot_ < slot) slots_[++slot_ % slots_.size()] = {};
    const auto periods = static_cast<double>(lost + 1);
    Slot& now = slots_[slot % slots_.size()];
    now.lost += static_cast<double>(lost);
    now.excess += periods * periods - periods;
    const double rise = kRisePerS * dt_s;
    gain_ = std::min(target(), gain_ + rise);
  }
  void clear() noexcept {
    slots_.fill({});
    gain_ = 1;
  }

  /// Share of lost ticks in the last second, 0 to 1.
  double share() const noexcept {
    double lost = 0;
    for (const Slot& slot : slots_) lost += slot.lost;
    return lost / kTicksPerS;
  }
  /// Factor of the force, 0.2 to 1. Falls at once when ticks are lost and rises by 2 per second.
  double gain() const noexcept { return gain_; }

 private:
  static constexpr std::uint64_t kSlotUs = 100'000;
  static constexpr double kTicksPerS = 1000;
  static constexpr double kRisePerS = 2;

  struct Slot {
    double lost = 0;
    double excess = 0;  ///< sum of dt² - dt, in periods
  };

  double target() const noexcept {
    double excess = 0;
    for (const Slot& slot : slots_) excess += slot.excess;
    return kTicksPerS / (kTicksPerS + excess);
  }

  std::array<Slot, 10> slots_{};
  std::uint64_t slot_ = 0;
  double gain_ = 1;
};

}  // namespace kerf::agent
