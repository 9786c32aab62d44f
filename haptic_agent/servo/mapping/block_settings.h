// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

/// Returns the settings of a device as it is seen in the block through a mapping: what a model
/// renders there with these stays stable at the device. The servo cycle itself uses the device's
/// own settings.
ServoSettings block_settings(const ServoSettings& device, const WorkspaceMapping& mapping) noexcept;

}  // namespace kerf::agent
