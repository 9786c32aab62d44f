// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <string_view>

#include "haptic_agent/device/device_choice.h"

namespace kerf::agent {

/// Like choose_device; also accepts `sim:FILE.mcap` and `replay:FILE.mcap`, with the path of a
/// recording (path_of).
std::expected<DeviceChoice, std::string> choose_device_or_recording(std::string_view text);

}  // namespace kerf::agent
