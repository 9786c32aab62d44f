// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "haptic_agent/servo/contact_model.h"
#include "haptic_agent/servo/cut_coupling.h"
#include "haptic_agent/servo/engagement_trend.h"
#include "haptic_agent/servo/grip_history.h"

namespace kerf::agent {

/// The server's force laws (server/wire/README.md, "force").
enum class CutLaw : std::uint8_t {
  /// The cutting force depends on the engaged area only.
  kSpecificEnergy,
  /// The cutting force is proportional to the tool's speed, like that of a damper.
  kRemovalRate,
  /// The force of a milling cutter: it follows the chips of each motion, and may contain the ripple
  /// of the teeth.
  kMechanistic,
};

/// Names of the laws in scenes and on the wire.
inline constexpr std::array<std::string_view, 3> kCutLawNames = {"specific_energy", "drr",
                                                                 "mechanistic"};
constexpr std::string_view to_string(CutLaw law) noexcept {
  return kCutLawNames[static_cast<std::size_t>(law)];
}

struct ModelSettings {
  CutLaw law = CutLaw::kSpecificEnergy;
  ContactLimits contact{};
  /// Damping that the device renders stably at 1 kHz, N s/mm.
  double max_damping = 0.02;
  /// Greatest frequency of the tooth ripple that the device renders, Hz; 0: unlimited.
  double max_vibration_hz = 0;
};

/// Extrapolates the server's answers, which are a round trip old, to the current grip and velocity.
/// The magnitude of the cutting force follows the path of the tip, its direction the motion of the
/// tool. The contacts act as springs. Each new answer corrects the model without a step.
class LocalModel {
 public:
  explicit LocalModel(const ModelSettings& settings) noexcept
      : settings_(settings),
        stock_(settings.contact, wire::kContactStock),
        obstacles_(settings.contact, wire::kContactObstacle),
        coupling_(cut_limits(settings.contact),
                  settings.law == CutLaw::kMechanistic ? kMillingMmPerN : kCutMmPerN) {}

  /// Adds an answer of the server. `then`: the grip that was sent; `now`: the measured one. If the
  /// replica has already answered a newer pose, only the obstacles of this answer are used.
  void take(const ServerWrench& answer, const PastGrip& then, const PastGrip& now) noexcept;
  /// Adds an answer of the local replica, which has no obstacles.
  void take_replica(const ServerWrench& answer, const PastGrip& then, const PastGrip& now) noexcept;
  /// Returns the wrench at the newest grip, `dt_s` after the previous one. The cut is rendered at
  /// `now`, the grip estimated between encoder steps, and the contacts at `measured`. `cutting`:
  /// the cutting button is pressed.
  Wrench at(const PastGrip& now, const PastGrip& measured, bool cutting, double dt_s) noexcept;
  /// Returns the wrench of the last call of `at` as the session computes it, before the reduction
  /// to the stiffness and damping that the device renders stably.
  const Wrench& computed() const noexcept { return computed_; }
  /// Returns the compliance through which the last call of `at` rendered the cut, or 0 if rigid or
  /// without a cut.
  double compliance_mm_per_n() const noexcept { return compliance_; }

  /// Returns the direction of travel, low-pass filtered over the path (PastGrip::heading): a vector
  /// of length <= 1 that passes through zero when the motion reverses.
  static Vec3 heading(Vec3 before, Vec3 moved_mm) noexcept;

 private:
  /// Compliance that is permitted for a cut on any device. A hand of 0.5 N/mm, which yields by
  /// more, is shaken with less (found by trial, `felt_bench hands`).
  static constexpr double kCutMmPerN = 4;
  /// The force of a milling cutter also pushes laterally, which drives an elastic tool.
  static constexpr double kMillingMmPerN = 8;

  /// Returns the cutting wrench as computed; `rendered` is the share that the device can render.
  /// `arm`: see below.
  Wrench cut(const PastGrip& now, Vec3 arm, double& rendered) const noexcept;
  /// Returns the arm from the pivot to the middle of the cut.
  Vec3 arm(const PastGrip& now) const noexcept;
  Wrench within_band(const Wrench& cutting, double dt_s) noexcept;
  void take_stock(const ServerWrench& answer, const PastGrip& then, const PastGrip& now) noexcept;
  void take_cut(const ServerWrench& answer, const PastGrip& then) noexcept;

  ModelSettings settings_;
  ContactModel stock_, obstacles_;
  CutCoupling coupling_;
  EngagementTrend trend_;
  /// Cutting wrench of the newest answer.
  Wrench cut_;
  Wrench computed_;
  /// Cutting wrench within the device's band, while it cuts.
  Wrench in_band_;
  PastGrip then_;
  Vec3 arm_mm_{};
  double lag_s_ = 0;
  double compliance_ = 0;
  /// Time of the newest pose whose stock contact and cut were answered.
  std::uint64_t answered_us_ = 0;
};

}  // namespace kerf::agent
