// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "haptic_agent/device/spacemouse/space_report.h"

struct input_event;

namespace kerf::agent {

/// The axes of a gamepad that are used, in the order of PadCodes.
enum class PadAxis : std::uint8_t { kLeftX, kLeftY, kRightX, kRightY, kLeftTrigger, kRightTrigger };
inline constexpr std::size_t kPadAxes = 6;

/// Event codes of the axes (ABS_... of linux/input-event-codes.h).
using PadCodes = std::array<std::uint16_t, kPadAxes>;

/// Returns the codes under which a pad reports its axes. Linux's gamepad drivers report the right
/// stick as RX and RY, and the triggers as Z and RZ. Generic HID pads, such as an Xbox pad over
/// Bluetooth, report that stick as Z and RZ, and the triggers as BRAKE and GAS or not at all.
/// `has_rx_ry`: the pad has RX and RY; `has_gas_brake`: it has GAS and BRAKE.
PadCodes pad_codes(bool has_rx_ry, bool has_gas_brake) noexcept;

/// Least and greatest value that an axis reports; unknown if equal.
struct AxisRange {
  std::int32_t least = 0, most = 0;
};

/// The command of a gamepad.
struct PadState {
  /// Left stick: across; triggers: up and down; right stick: tilt. Buttons are numbered as on a
  /// SpaceMouse: bit 0 cuts (A, or a cross), bit 1 selects a fifth of the speed (left shoulder),
  /// bit 2 undoes (B, or a circle), bit 3 redoes (right shoulder).
  CapDeflection cap{};
  /// Presses of the button for the next tool (BTN_NORTH) minus presses for the previous one
  /// (BTN_WEST). On a pad whose driver reports positions these are the upper button (a triangle)
  /// and the left one (a square). xpad, the driver of Xbox pads, reports labels instead: X has the
  /// code of BTN_NORTH, Y that of BTN_WEST.
  std::int32_t tool_steps = 0;

  bool operator==(const PadState&) const = default;
};

/// Decodes the events of a gamepad (linux/input.h). Accepts any event.
class GamepadReport {
 public:
  /// Default: pad_codes(true, false).
  void set_codes(const PadCodes& codes) noexcept { codes_ = codes; }
  void set_range(PadAxis axis, AxisRange range) noexcept;
  /// Returns whether the state changed.
  bool take(const input_event& event) noexcept;
  /// Marks all sticks, triggers and buttons as released.
  void release() noexcept;
  const PadState& state() const noexcept { return state_; }

 private:
  void take_key(std::uint16_t code, bool pressed) noexcept;
  double stick(PadAxis axis) const noexcept;
  double trigger(PadAxis axis) const noexcept;

  PadCodes codes_ = pad_codes(true, false);
  std::array<AxisRange, kPadAxes> ranges_{};
  std::array<std::int32_t, kPadAxes> values_{};
  PadState state_;
};

}  // namespace kerf::agent
