// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace kerf::agent {

/// Transfer type of an endpoint, with the values of bmAttributes.
enum class TransferKind : std::uint8_t { kBulk = 2, kInterrupt = 3 };

/// One endpoint of a configuration descriptor.
struct EndpointShape {
  /// bEndpointAddress; bit 7 is set for IN (device to host).
  std::uint8_t address = 0;
  /// The two lowest bits of bmAttributes.
  std::uint8_t kind = 0;
  std::uint16_t max_packet_bytes = 0;
};

/// One alternate setting of one interface.
struct InterfaceShape {
  std::uint8_t number = 0;
  std::uint8_t alternate = 0;
  std::uint8_t usb_class = 0;
  std::uint8_t usb_subclass = 0;
  std::uint8_t usb_protocol = 0;
  std::vector<EndpointShape> endpoints{};
};

/// The endpoints that a driver needs. kAnyClass matches every class.
struct PipeRequirements {
  static constexpr int kAnyClass = -1;
  int usb_class = kAnyClass;
  int usb_subclass = kAnyClass;
  int usb_protocol = kAnyClass;
  TransferKind kind = TransferKind::kInterrupt;
  /// Whether an OUT endpoint is needed; not for devices without motors.
  bool needs_out = true;
  /// Packet size that the driver's reports need.
  std::uint16_t min_packet_bytes = 1;
};

/// The endpoints to use. `out` is 0 if none is needed.
struct Pipes {
  std::uint8_t interface_number = 0;
  std::uint8_t alternate = 0;
  std::uint8_t in = 0;
  std::uint8_t out = 0;
  std::uint16_t in_packet_bytes = 0;
  std::uint16_t out_packet_bytes = 0;
};

/// Returns the endpoints of the first setting that meets the requirements. Addresses are not
/// assumed: device controllers give the same firmware different ones.
std::optional<Pipes> find_pipes(std::span<const InterfaceShape> interfaces,
                                const PipeRequirements& required);

}  // namespace kerf::agent
