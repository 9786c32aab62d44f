// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace kerf::agent {

/// What can go wrong with a device at the bus, as far as a user or the driver acts on it.
enum class UsbFault : std::uint8_t {
  /// No device of these ids is plugged in.
  kNotFound,
  /// It is there, and this user may not open its node.
  kPermission,
  /// Another program or driver holds its interface.
  kBusy,
  /// Its descriptors or its answer are not those of the device that its ids promise.
  kWrongDevice,
  kUnplugged,
  /// The endpoint rejected; it wants its halt cleared.
  kStall,
  /// It sent more than its endpoint's packet (babble).
  kOverflow,
  kTimeout,
  /// Whatever else the bus or the system reports; in bursts often an unplugged device.
  kIo,
};

/// A fault with one sentence for the user: what is wrong and what to do.
struct UsbError {
  UsbFault fault = UsbFault::kIo;
  std::string text{};
};

/// The sentence for a fault of `device` (a name such as "Novint Falcon"). `detail` (a path, a
/// descriptor's fault) is added where it is not empty.
UsbError usb_error(UsbFault fault, std::string_view device, std::string_view detail = {});

/// The fault behind a negative code of libusb.
UsbFault fault_of(int libusb_code) noexcept;

}  // namespace kerf::agent
