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

/// A kind of device that kerf-agent recognizes.
struct KnownDevice {
  std::string_view name{};
  /// Its value of --device. Empty if recognized but not supported, because its protocol is closed
  /// and needs the vendor's SDK.
  std::string_view word{};
  std::vector<UsbId> ids{};
};

/// Returns all recognized kinds.
const std::vector<KnownDevice>& known_devices();

/// A recognized device on the bus.
struct FoundDevice {
  std::string_view name{};
  std::string_view word{};
  UsbId id{};
  /// "/dev/bus/usb/001/004"
  std::string node{};
  /// The fault on opening it. Empty if it could be opened.
  std::optional<UsbFault> fault{};
};

/// Lists the recognized devices on the bus; opens each one briefly without claiming it. The error
/// is one sentence: USB is not available.
std::expected<std::vector<FoundDevice>, std::string> survey_usb();

}  // namespace kerf::agent
