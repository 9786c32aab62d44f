// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/servo/contact_model.h"
#include "haptic_agent/servo/engagement_trend.h"
#include "haptic_agent/servo/hold_history.h"

namespace kerf::agent {

/// The two laws of the server (server/wire/README.md, "force").
enum class CutLaw : std::uint8_t {
  /// The cut pushes with a force that depends on the engaged area alone.
  kSpecificEnergy,
  /// It pushes the harder the faster the tool goes: a damper.
  kRemovalRate,
};

struct ModelSettings {
  CutLaw law = CutLaw::kSpecificEnergy;
  /// What the device shows stably at 1 kHz.
  double stiffness_most = 1.5;
  double damping_most = 0.02;
};

/// Renders what the server answered a round trip ago for where the hand is now and how it moves
/// now: the cut, whose strength follows the way of the tip and whose direction follows the hand's,
/// and the contact. The newest answer corrects it; nothing of it is a step.
class LocalModel {
 public:
  explicit LocalModel(const ModelSettings& settings) noexcept
      : settings_(settings),
        stock_(settings.stiffness_most, wire::kContactStock),
        obstacles_(settings.stiffness_most, wire::kContactObstacle) {}

  /// What the server answered; `then` is where the hand was when the answered pose was measured.
  /// Of an answer to an older pose than one that was answered near by, only the obstacles count.
  void take(const ServerWrench& answer, const PastHold& then, const PastHold& now) noexcept;
  /// What a copy of the block near the tool answered, which knows no obstacles.
  void take_near(const ServerWrench& answer, const PastHold& then, const PastHold& now) noexcept;
  /// The wrench at the newest hold, `dt_s` after the one before. `cutting`: the hand asks to cut.
  Wrench at(const PastHold& now, bool cutting, double dt_s) noexcept;

  /// Where the tool has been going, as `PastHold::heading` wants it: the last mm of the way, as a
  /// vector no longer than 1, so that a hand that turns back passes through zero.
  static Vec3 heading(Vec3 before, Vec3 moved_mm) noexcept;

 private:
  Wrench cut(const PastHold& now) const noexcept;
  void take_stock(const ServerWrench& answer, const PastHold& then, const PastHold& now) noexcept;
  void take_cut(const ServerWrench& answer, const PastHold& then) noexcept;

  ModelSettings settings_;
  ContactModel stock_, obstacles_;
  EngagementTrend trend_;
  /// The cut as it was answered.
  Wrench cut_;
  PastHold then_;
  Vec3 arm_mm_{};
  double lag_s_ = 0;
  /// The newest pose that stock and cut were answered for.
  std::uint64_t answered_us_ = 0;
};

}  // namespace kerf::agent
