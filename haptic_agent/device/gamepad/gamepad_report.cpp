// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/gamepad/gamepad_report.h"

#include <linux/input.h>

#include <algorithm>
#include <numeric>

namespace kerf::agent {
namespace {

constexpr std::uint32_t kCutKey = 1, kSlowKey = 2, kUndoKey = 4, kRedoKey = 8;

constexpr std::size_t axis_index(PadAxis axis) noexcept { return static_cast<std::size_t>(axis); }

}  // namespace

PadCodes pad_codes(bool has_rx_ry, bool has_gas_brake) noexcept {
  if (has_gas_brake || !has_rx_ry) return {ABS_X, ABS_Y, ABS_Z, ABS_RZ, ABS_BRAKE, ABS_GAS};
  return {ABS_X, ABS_Y, ABS_RX, ABS_RY, ABS_Z, ABS_RZ};
}

void GamepadReport::set_range(PadAxis axis, AxisRange range) noexcept {
  ranges_[axis_index(axis)] = range;
  release();
}

void GamepadReport::release() noexcept {
  constexpr std::size_t kFirstTrigger = axis_index(PadAxis::kLeftTrigger);
  for (std::size_t i = 0; i < kPadAxes; ++i) {
    const AxisRange& range = ranges_[i];
    values_[i] = i < kFirstTrigger ? std::midpoint(range.least, range.most) : range.least;
  }
  state_.cap = {};
}

/// -1 … 1, 0 at the center.
double GamepadReport::stick(PadAxis axis) const noexcept {
  const AxisRange& range = ranges_[axis_index(axis)];
  const double half = (static_cast<double>(range.most) - range.least) / 2;
  if (!(half > 0)) return 0;
  return std::clamp((values_[axis_index(axis)] - (range.least + half)) / half, -1.0, 1.0);
}

/// 0 … 1.
double GamepadReport::trigger(PadAxis axis) const noexcept {
  const AxisRange& range = ranges_[axis_index(axis)];
  const double width = static_cast<double>(range.most) - range.least;
  if (!(width > 0)) return 0;
  return std::clamp((static_cast<double>(values_[axis_index(axis)]) - range.least) / width, 0.0,
                    1.0);
}

void GamepadReport::take_key(std::uint16_t code, bool pressed) noexcept {
  const auto set = [&](std::uint32_t bit) {
    state_.cap.buttons = pressed ? state_.cap.buttons | bit : state_.cap.buttons & ~bit;
  };
  if (code == BTN_SOUTH) set(kCutKey);
  if (code == BTN_TL) set(kSlowKey);
  if (code == BTN_EAST) set(kUndoKey);
  if (code == BTN_TR) set(kRedoKey);
  if (code == BTN_NORTH && pressed) ++state_.tool_steps;
  if (code == BTN_WEST && pressed) --state_.tool_steps;
}

bool GamepadReport::take(const input_event& event) noexcept {
  const PadState before = state_;
  if (event.type == EV_KEY && event.value <= 1) take_key(event.code, event.value == 1);
  if (event.type != EV_ABS) return state_ != before;
  const auto found = std::ranges::find(codes_, event.code);
  if (found == codes_.end()) return false;
  values_[static_cast<std::size_t>(found - codes_.begin())] = event.value;
  // Sticks report up as negative. The right trigger lowers the tool.
  state_.cap.push = {stick(PadAxis::kLeftX), -stick(PadAxis::kLeftY),
                     trigger(PadAxis::kLeftTrigger) - trigger(PadAxis::kRightTrigger)};
  state_.cap.turn = {stick(PadAxis::kRightY), stick(PadAxis::kRightX), 0};
  return state_ != before;
}

}  // namespace kerf::agent
