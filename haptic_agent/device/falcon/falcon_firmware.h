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

/// Sets the serial chip up for talking to a running firmware.
std::expected<void, UsbFault> enter_run_mode(UsbTalk& talk);

/// Does a firmware run? Sends one command without force and waits for its answer.
bool answers(UsbTalk& talk);

/// Loads a firmware; the Falcon has none after it was switched on. The loader is known to fail by
/// itself now and then, so that it is tried several times. The error says at which step the last
/// attempt ended.
std::expected<void, UsbError> load_firmware(UsbTalk& talk, std::string_view device,
                                            std::span<const std::uint8_t> firmware);

/// Reads a firmware file (1 byte to 1 MiB); the error is one sentence.
std::expected<std::vector<std::uint8_t>, std::string> read_firmware(const std::string& path);

}  // namespace kerf::agent::falcon
