// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "haptic_agent/device/spacemouse/space_report.h"

struct input_event;

namespace kerf::agent {

/// The axes of a gamepad that are used, by the names of Linux (linux/input-event-codes.h).
enum class PadAxis : std::uint8_t { kX, kY, kRx, kRy, kZ, kRz };
inline constexpr std::size_t kPadAxes = 6;

/// Least and greatest value that an axis reports; unknown if equal.
struct AxisRange {
  std::int32_t least = 0, most = 0;
};

/// What a gamepad commands.
struct PadState {
  /// Left stick: across; triggers: up and down; right stick: tilt. Buttons as of a SpaceMouse: bit
  /// 0 cuts (A, or a cross), bit 1 is the fifth of the speed (left shoulder).
  CapDeflection cap{};
  /// Presses of the button for the next tool (Y, or a triangle) less those for the previous one (X,
  /// or a square).
  std::int32_t tool_steps = 0;

  bool operator==(const PadState&) const = default;
};

/// Decodes the events of a gamepad (linux/input.h). Whatever the device sends is valid.
class GamepadReport {
 public:
  void set_range(PadAxis axis, AxisRange range) noexcept;
  /// Returns whether the state changed.
  bool take(const input_event& event) noexcept;
  /// All sticks, triggers and buttons are released.
  void release() noexcept;
  const PadState& state() const noexcept { return state_; }

 private:
  void take_key(std::uint16_t code, bool pressed) noexcept;
  double stick(PadAxis axis) const noexcept;
  double trigger(PadAxis axis) const noexcept;

  std::array<AxisRange, kPadAxes> ranges_{};
  std::array<std::int32_t, kPadAxes> values_{};
  PadState state_;
};

}  // namespace kerf::agent
