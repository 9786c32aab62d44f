// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

/// Z-width of a device: the stiffest wall that it renders stably, with the strongest damper in
/// parallel. `along`: along the tool's axis; `across`: at the tip, where a push also turns the
/// device.
struct ZWidth {
  ContactGains along{}, across{};
};
/// `settings`: the result of settings_for.
ZWidth z_width(const ServoSettings& settings) noexcept;

/// Returns a line with the Z-width of a device and, if that is below the declared stiffness, the
/// reason. Empty for a device without motors.
std::string z_width_notice(const DeviceCapabilities& device, const ServoSettings& settings);

}  // namespace kerf::agent
