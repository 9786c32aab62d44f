// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/mapping/hand_mapping.h"

#include <algorithm>
#include <utility>

namespace kerf::agent {
namespace {

/// Returns the buttons of the device that act as the clutch.
std::uint32_t buttons_of(ClutchButton clutch) noexcept {
  switch (clutch) {
    case ClutchButton::kUndo:
      return kButtonClutch | kButtonUndo;
    case ClutchButton::kRedo:
      return kButtonClutch | kButtonRedo;
    default:
      return kButtonClutch;
  }
}

}  // namespace

bool HandMapping::is_clutch(std::uint32_t buttons) const noexcept {
  const bool released = (buttons & wire::kButtonDeadman) == 0;
  return (buttons & buttons_of(clutch_)) != 0 || (clutch_ == ClutchButton::kDeadman && released);
}

/// Returns whether the mapping has changed.
bool HandMapping::take_change(Vec3 device_tip_mm) noexcept {
  if (!request_) return false;
  const MappingRequest request = *std::exchange(request_, std::nullopt);
  map_ = SpaceMap(request.mapping);
  if (request.keeps_tool && tool_mm_) map_ = map_.placed(device_tip_mm, *tool_mm_);
  return true;
}

DeviceState HandMapping::follow(const DeviceState& device, std::uint64_t now_us) noexcept {
  has_resumed_ = false;
  DeviceState tool = device;
  tool.buttons &= ~buttons_of(clutch_);
  if (!device.valid || !is_finite(device.tip_mm)) return tool;
  const bool changed = take_change(device.tip_mm);
  const bool was_away = std::exchange(is_away_, is_clutch(device.buttons));
  if (is_away_ && tool_mm_ && !changed) map_ = map_.placed(device.tip_mm, *tool_mm_);
  if (is_away_ || changed) tool.buttons &= ~wire::kButtonCutting;
  has_resumed_ = !is_away_ && (was_away || changed);
  if (has_resumed_) {
    valid_from_us_ = device.time_us;
    resumed_us_ = now_us;
  }
  tool.tip_mm = map_.to_block(device.tip_mm);
  tool.axis = map_.turned_to_block(device.axis);
  tool_mm_ = tool.tip_mm;
  return tool;
}

double HandMapping::share(std::uint64_t now_us) const noexcept {
  if (is_away_) return 0;
  if (resumed_us_ == 0) return 1;
  return std::min(1.0, static_cast<double>(now_us - resumed_us_) / kResumeUs);
}

}  // namespace kerf::agent
