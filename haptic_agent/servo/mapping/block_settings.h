// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

/// Returns the settings of a device as seen in the block through a mapping: a model that is stable
/// in the block with these is stable at the device. Mass, stiffness and damping are divided by gain
/// times scale, inertia by gain over scale. The servo cycle itself uses the device's own settings.
ServoSettings block_settings(const ServoSettings& device, const WorkspaceMapping& mapping) noexcept;

}  // namespace kerf::agent
