// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "haptic_agent/device/usb/usb_protocol.h"
#include "kernel/math/vec3.h"

namespace kerf::agent {

/// Translation and rotation of the cap of a SpaceMouse, in Kerf's axes (x right, y away from the
/// user, z up), each component in -1 … 1, and the buttons, the left one in bit 0.
struct CapDeflection {
  Vec3 push{};
  Vec3 turn{};
  std::uint32_t buttons = 0;

  bool operator==(const CapDeflection&) const = default;
};

/// USB ids of 3Dconnexion's six-axis devices, from spacenavd.
std::vector<UsbId> space_mouse_ids();

/// Id of the HID report that contains only buttons.
inline constexpr std::uint8_t kButtonReport = 3;

/// Decodes a HID report into `cap`: 1 (push, 6 bytes; on newer models push and turn, 12 bytes), 2
/// (turn) or 3 (buttons). Returns false for other reports and leaves `cap` unchanged.
bool take_space_report(std::span<const std::uint8_t> report, CapDeflection& cap) noexcept;

/// Maps |value| <= kDeadZone to zero and the rest continuously to 0 … 1: a cap at rest does not
/// report exactly zero.
inline constexpr double kDeadZone = 0.08;
double without_dead_zone(double value) noexcept;

}  // namespace kerf::agent
