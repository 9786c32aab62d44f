// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "haptic_agent/device/usb/usb_protocol.h"
#include "kernel/math/vec3.h"

namespace kerf::agent {

/// What the cap of a SpaceMouse is pushed and turned by, in Kerf's directions (x right, y away from
/// the user, z up), each part -1 … 1, and its buttons, the left one in bit 0.
struct CapDeflection {
  Vec3 push{};
  Vec3 turn{};
  std::uint32_t buttons = 0;

  bool operator==(const CapDeflection&) const = default;
};

/// The ids of 3Dconnexion's six-axis devices, as spacenavd lists them.
std::vector<UsbId> space_mouse_ids();

/// The HID report that tells of buttons only.
inline constexpr std::uint8_t kButtonReport = 3;

/// Takes one HID report into `cap`: report 1 (push, 6 bytes; or push and turn, 12 bytes, of newer
/// models), 2 (turn), 3 (buttons). False, and `cap` untouched, if it is none of these.
bool take_space_report(std::span<const std::uint8_t> report, CapDeflection& cap) noexcept;

/// `value` without its innermost `kDeadZone`, the rest stretched so that nothing jumps: a cap at
/// rest never reads exactly zero.
inline constexpr double kDeadZone = 0.08;
double without_dead_zone(double value) noexcept;

}  // namespace kerf::agent
