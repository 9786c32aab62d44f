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

/// The descriptors' data: a device with one interface and one endpoint per direction.
struct UsbShape {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint8_t usb_class = 0xFF;
  std::uint8_t usb_subclass = 0;
  std::uint8_t usb_protocol = 0;
  /// 2 for bulk, 3 for interrupt.
  std::uint8_t kind = 3;
  std::uint8_t in_address = 0x81;
  /// 0 for no OUT endpoint.
  std::uint8_t out_address = 0x02;
  std::uint16_t packet_bytes = 64;
};

/// Returns device and configuration descriptor, concatenated as in usbfs and sysfs.
Bytes descriptors_of(const UsbShape& shape);

/// The behavior of a device, independent of the bus. The routes (in-process usbfs, umockdev, a
/// gadget in a real kernel) transfer the bytes and call it from one thread at a time, with a
/// monotonic clock in microseconds.
class UsbModel {
 public:
  virtual ~UsbModel() = default;
  virtual UsbShape shape() const = 0;
  /// Returns the answer's data (empty for a request without data), or nullopt to stall.
  virtual std::optional<Bytes> control(const Setup& setup, std::span<const std::uint8_t> data) = 0;
  /// Returns the next IN packet, or nullopt.
  virtual std::optional<Bytes> poll_in(std::uint64_t now_us) = 0;
  virtual void take_out(std::span<const std::uint8_t> packet, std::uint64_t now_us) = 0;
  /// Call when the device was unplugged or plugged in: resets the volatile state.
  virtual void power_cycle() = 0;
};

}  // namespace kerf::usb_test
