// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace kerf::agent {

/// Faults of a device on the bus that users or the driver handle differently.
enum class UsbFault : std::uint8_t {
  /// No device of these ids is plugged in.
  kNotFound,
  /// The user lacks permission to open the device node.
  kPermission,
  /// Another program or driver has claimed its interface.
  kBusy,
  /// Its descriptors or its identity do not match its USB ids.
  kWrongDevice,
  kUnplugged,
  /// The endpoint is halted, until the halt is cleared.
  kStall,
  /// It sent more than the packet size of its endpoint (babble).
  kOverflow,
  kTimeout,
  /// Any other error of the bus or the system; many in succession often mean an unplugged device.
  kIo,
};

/// A fault with a sentence for the user: the cause and the remedy.
struct UsbError {
  UsbFault fault = UsbFault::kIo;
  std::string text{};
};

/// Returns the error for a fault of `device` (a name such as "Novint Falcon"). A non-empty `detail`
/// is appended in parentheses.
UsbError usb_error(UsbFault fault, std::string_view device, std::string_view detail = {});

/// Maps a negative error code of libusb to a fault.
UsbFault fault_of(int libusb_code) noexcept;

}  // namespace kerf::agent
