// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptic_agent/device/usb/usb_fault.h"
#include "haptic_agent/device/usb/usb_protocol.h"

namespace kerf::agent {

/// A kind of device that somebody may have plugged in.
struct KnownDevice {
  std::string_view name{};
  /// The word for --device; empty: known, but its protocol is closed and needs its vendor's SDK.
  std::string_view word{};
  std::vector<UsbId> ids{};
};

/// Every kind that a doctor can name.
const std::vector<KnownDevice>& known_devices();

/// One of them on the bus.
struct FoundDevice {
  std::string_view name{};
  std::string_view word{};
  UsbId id{};
  /// "/dev/bus/usb/001/004"
  std::string node{};
  /// What opening it met; nothing: it opened.
  std::optional<UsbFault> fault{};
};

/// Looks at the bus and opens each known device for a moment, without claiming it. The error is one
/// sentence: USB cannot be used at all.
std::expected<std::vector<FoundDevice>, std::string> survey_usb();

}  // namespace kerf::agent
