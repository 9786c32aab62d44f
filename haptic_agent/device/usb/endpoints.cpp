// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/usb/endpoints.h"

#include <algorithm>

namespace kerf::agent {
namespace {

constexpr std::uint8_t kTowardsHost = 0x80;
/// Interrupt and bulk packets are never larger (high speed).
constexpr std::uint16_t kMostPacketBytes = 1024;

bool fits(int wished, std::uint8_t is) noexcept {
  return wished == PipeWish::kAnyClass || wished == is;
}

const EndpointShape* find_endpoint(const InterfaceShape& shape, const PipeWish& wish,
                                   std::uint8_t direction) noexcept {
  const auto found = std::ranges::find_if(shape.endpoints, [&](const EndpointShape& endpoint) {
    return (endpoint.address & kTowardsHost) == direction &&
           endpoint.kind == static_cast<std::uint8_t>(wish.kind) &&
           endpoint.max_packet_bytes >= wish.least_packet_bytes &&
           endpoint.max_packet_bytes <= kMostPacketBytes;
  });
  return found == shape.endpoints.end() ? nullptr : &*found;
}

}  // namespace

std::optional<Pipes> find_pipes(std::span<const InterfaceShape> interfaces, const PipeWish& wish) {
  for (const InterfaceShape& shape : interfaces) {
    if (!fits(wish.usb_class, shape.usb_class) || !fits(wish.usb_subclass, shape.usb_subclass) ||
        !fits(wish.usb_protocol, shape.usb_protocol)) {
      continue;
    }
    const EndpointShape* in = find_endpoint(shape, wish, kTowardsHost);
    const EndpointShape* out = wish.wants_out ? find_endpoint(shape, wish, 0) : nullptr;
    if (in == nullptr || (wish.wants_out && out == nullptr)) continue;
    return Pipes{.interface_number = shape.number,
                 .alternate = shape.alternate,
                 .in = in->address,
                 .out = out != nullptr ? out->address : std::uint8_t{0},
                 .in_packet_bytes = in->max_packet_bytes,
                 .out_packet_bytes = out != nullptr ? out->max_packet_bytes : std::uint16_t{0}};
  }
  return std::nullopt;
}

}  // namespace kerf::agent
