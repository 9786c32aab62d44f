// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptic_agent/device/usb/usb_protocol.h"

namespace kerf::agent::falcon {

/// Configures the serial chip for a running firmware.
std::expected<void, UsbFault> enter_run_mode(UsbSyncIo& io);

/// Returns whether a firmware is running: sends one command without force and waits for the answer.
bool answers(UsbSyncIo& io);

/// Loads a firmware, which the Falcon loses with its power. The loader fails occasionally, so
/// several attempts are made. The error names the step at which the last attempt failed.
std::expected<void, UsbError> load_firmware(UsbSyncIo& io, std::string_view device,
                                            std::span<const std::uint8_t> firmware);

/// Reads a firmware file of 1 byte to 1 MiB. The error is one sentence.
std::expected<std::vector<std::uint8_t>, std::string> read_firmware(const std::string& path);

}  // namespace kerf::agent::falcon
