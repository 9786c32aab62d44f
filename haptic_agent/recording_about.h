// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "haptic_agent/link/control_message.h"
#include "haptic_agent/record/byte_writer.h"
#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

// The metadata "kerf" of recordings (record/README.md).

/// For a session. `user`: the name of its user; `device`: as rated by profile and command line.
mcap::Texts about_session(const std::string& user, const Welcome& welcome,
                          const DeviceCapabilities& device, const ServoSettings& settings);

/// For the playing of a recording. Device, limits and versions are those of the playing; session,
/// stock and force law are those of the recording, whose metadata are `recorded`. `feel_of` is
/// `file`.
mcap::Texts about_playing(const mcap::Texts& recorded, const std::string& file,
                          const DeviceCapabilities& device, const ServoSettings& settings);

}  // namespace kerf::agent
