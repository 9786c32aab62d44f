// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace kerf::agent {

/// How an endpoint moves data, with the numbers of bmAttributes.
enum class TransferKind : std::uint8_t { kBulk = 2, kInterrupt = 3 };

/// What a configuration descriptor says of one endpoint.
struct EndpointShape {
  /// bEndpointAddress; bit 7 set: towards the host.
  std::uint8_t address = 0;
  /// bmAttributes, its two lowest bits.
  std::uint8_t kind = 0;
  std::uint16_t max_packet_bytes = 0;
};

/// What it says of one alternate setting of one interface.
struct InterfaceShape {
  std::uint8_t number = 0;
  std::uint8_t alternate = 0;
  std::uint8_t usb_class = 0;
  std::uint8_t usb_subclass = 0;
  std::uint8_t usb_protocol = 0;
  std::vector<EndpointShape> endpoints{};
};

/// What a driver looks for. A class of kAnyClass fits all.
struct PipeWish {
  static constexpr int kAnyClass = -1;
  int usb_class = kAnyClass;
  int usb_subclass = kAnyClass;
  int usb_protocol = kAnyClass;
  TransferKind kind = TransferKind::kInterrupt;
  /// Without motors nothing need go out.
  bool wants_out = true;
  /// The least packet that its reports fit in.
  std::uint16_t least_packet_bytes = 1;
};

/// Where to read and write. `out` is 0 where none was wished for.
struct Pipes {
  std::uint8_t interface_number = 0;
  std::uint8_t alternate = 0;
  std::uint8_t in = 0;
  std::uint8_t out = 0;
  std::uint16_t in_packet_bytes = 0;
  std::uint16_t out_packet_bytes = 0;
};

/// The first setting that has what is wished for. Addresses are never assumed: device controllers
/// give the same firmware different ones.
std::optional<Pipes> find_pipes(std::span<const InterfaceShape> interfaces, const PipeWish& wish);

}  // namespace kerf::agent
