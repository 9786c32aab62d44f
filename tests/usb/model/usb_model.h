// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace kerf::usb_test {

using Bytes = std::vector<std::uint8_t>;

struct Setup {
  std::uint8_t type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;
};

/// What a device says of itself and of its one interface with one endpoint each way.
struct UsbShape {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint8_t usb_class = 0xFF;
  std::uint8_t usb_subclass = 0;
  std::uint8_t usb_protocol = 0;
  /// 2 bulk, 3 interrupt.
  std::uint8_t kind = 3;
  std::uint8_t in_address = 0x81;
  /// 0: no OUT endpoint.
  std::uint8_t out_address = 0x02;
  std::uint16_t packet_bytes = 64;
};

/// Device and configuration descriptor, one after the other, as usbfs and sysfs give them.
Bytes descriptors_of(const UsbShape& shape);

/// A device behind a bus: what it answers, without any bus's mechanics. The routes (an in-process
/// usbfs, umockdev, a gadget in a real kernel) carry the bytes and call it from one thread at a
/// time, with a clock in microseconds that never goes back.
class UsbModel {
 public:
  virtual ~UsbModel() = default;
  virtual UsbShape shape() const = 0;
  /// The answer's data (empty for a request without), or nothing: stall.
  virtual std::optional<Bytes> control(const Setup& setup, std::span<const std::uint8_t> data) = 0;
  /// The next packet towards the host, if there is one now.
  virtual std::optional<Bytes> poll_in(std::uint64_t now_us) = 0;
  virtual void take_out(std::span<const std::uint8_t> packet, std::uint64_t now_us) = 0;
  /// The plug is pulled or put in: whatever it knew in memory is gone.
  virtual void power_cycle() = 0;
};

}  // namespace kerf::usb_test
