// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/gamepad/rumble.h"

#include <algorithm>
#include <cstdlib>

namespace kerf::agent {
namespace {

constexpr double kFullMagnitude = 65535;
/// Smallest change that is output: 2 % of the full strength.
constexpr int kLeastChange = 1311;

std::uint16_t magnitude(double share) noexcept {
  return static_cast<std::uint16_t>(kFullMagnitude * std::clamp(share, 0.0, 1.0));
}

bool differ(std::uint16_t a, std::uint16_t b) noexcept {
  return std::abs(static_cast<int>(a) - static_cast<int>(b)) >= kLeastChange;
}

}  // namespace

RumbleLevel rumble_of(const Wrench& wrench) noexcept {
  if (!is_finite(wrench)) return {};
  return {.strong = magnitude(length(wrench.force_n) / kFullRumbleN),
          .weak = magnitude(length(wrench.torque_nmm) / kFullRumbleNmm)};
}

std::optional<RumbleLevel> RumbleClock::due(const RumbleLevel& level,
                                            std::uint64_t now_us) noexcept {
  const bool off = level == RumbleLevel{};
  const bool was_off = set_ == RumbleLevel{};
  if (off && was_off) return std::nullopt;
  const std::uint64_t passed_us = now_us - set_us_;
  const bool changed = differ(level.strong, set_.strong) || differ(level.weak, set_.weak);
  if (!off && passed_us < (changed || was_off ? kPeriodUs : kRenewUs)) return std::nullopt;
  set_ = level;
  set_us_ = now_us;
  return level;
}

}  // namespace kerf::agent
