// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf::agent {

/// Behavior of a user whose device gives no force: stops, lets go, holds the device again, waits a
/// while for the force, continues, and tries again later if there is still none.
class Regrip {
 public:
  enum class Act : std::uint8_t { kWork, kLetGo, kWait };

  /// Returns the user's action in the next `dt_s` seconds. `force_on`: forces are permitted now.
  Act step(bool force_on, double dt_s) noexcept {
    switch (act_) {
      case Act::kWork:
        off_s_ = force_on ? 0 : off_s_ + dt_s;
        if (off_s_ > kNoticeS) begin(Act::kLetGo, kLetGoS);
        break;
      case Act::kLetGo:
        left_s_ -= dt_s;
        if (left_s_ <= 0) begin(Act::kWait, kPatienceS);
        break;
      case Act::kWait:
        left_s_ -= dt_s;
        if (force_on || left_s_ <= 0) begin(Act::kWork, 0);
        if (act_ == Act::kWork && !force_on) off_s_ = kNoticeS - kAgainS;
        break;
    }
    return act_;
  }

 private:
  /// Time without a force until the user reacts. Longer than arming takes at the start.
  static constexpr double kNoticeS = 0.7;
  /// Longer than the supervisor asks for (0.3 s).
  static constexpr double kLetGoS = 0.4;
  static constexpr double kPatienceS = 2;
  static constexpr double kAgainS = 5;

  void begin(Act act, double for_s) noexcept {
    act_ = act;
    left_s_ = for_s;
    off_s_ = 0;
  }

  Act act_ = Act::kWork;
  double left_s_ = 0;
  double off_s_ = 0;
};

}  // namespace kerf::agent
