// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/math/vec3.h"

namespace kerf::agent {

/// The gesture that re-arms a device without a deadman after a trip: hold the tip still for a
/// second, then move it away by a centimeter and back within two seconds. It compares positions,
/// not speeds, so encoder steps (0.06 mm) do not matter. A device that rests or falls does not come
/// back, a tremor does not leave, and strokes do not hold still.
class RearmGesture {
 public:
  static constexpr std::uint64_t kStillUs = 1'000'000;
  /// How far the tip may stray while it is held still, mm.
  static constexpr double kStillMm = 2;
  static constexpr double kAwayMm = 10;
  /// Greatest distance from the held position at which the tip has come back, mm.
  static constexpr double kBackMm = 4;
  static constexpr std::uint64_t kMoveUs = 2'000'000;

  void restart() noexcept { act_ = Act::kNone; }

  /// Returns whether the gesture ends with this tick. `may`: whether the gesture counts now. If
  /// not, it starts again.
  bool done(Vec3 tip_mm, bool may, std::uint64_t now_us) noexcept {
    if (!may) act_ = Act::kNone;
    if (!may) return false;
    const double far_mm = length(tip_mm - place_mm_);
    switch (act_) {
      case Act::kNone:
        hold(tip_mm, now_us);
        break;
      case Act::kHeld:
        if (far_mm <= kStillMm) break;
        if (now_us - since_us_ < kStillUs) {
          hold(tip_mm, now_us);
        } else {
          act_ = Act::kMoving;
          since_us_ = now_us;
          was_away_ = false;
        }
        break;
      case Act::kMoving:
        was_away_ = was_away_ || far_mm >= kAwayMm;
        if (was_away_ && far_mm <= kBackMm) return true;
        if (now_us - since_us_ > kMoveUs) hold(tip_mm, now_us);
        break;
    }
    return false;
  }

 private:
  enum class Act : std::uint8_t { kNone, kHeld, kMoving };

  void hold(Vec3 tip_mm, std::uint64_t now_us) noexcept {
    act_ = Act::kHeld;
    place_mm_ = tip_mm;
    since_us_ = now_us;
  }

  Act act_ = Act::kNone;
  Vec3 place_mm_{};
  std::uint64_t since_us_ = 0;
  bool was_away_ = false;
};

}  // namespace kerf::agent
