// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/usb/endpoints.h"

#include <algorithm>

namespace kerf::agent {
namespace {

constexpr std::uint8_t kTowardsHost = 0x80;
/// Largest packet of interrupt and bulk endpoints at high speed.
constexpr std::uint16_t kMaxPacketBytes = 1024;

bool fits(int wished, std::uint8_t is) noexcept {
  return wished == PipeRequirements::kAnyClass || wished == is;
}

const EndpointShape* find_endpoint(const InterfaceShape& shape, const PipeRequirements& required,
                                   std::uint8_t direction) noexcept {
  const auto found = std::ranges::find_if(shape.endpoints, [&](const EndpointShape& endpoint) {
    return (endpoint.address & kTowardsHost) == direction &&
           endpoint.kind == static_cast<std::uint8_t>(required.kind) &&
           endpoint.max_packet_bytes >= required.min_packet_bytes &&
           endpoint.max_packet_bytes <= kMaxPacketBytes;
  });
  return found == shape.endpoints.end() ? nullptr : &*found;
}

}  // namespace

std::optional<Pipes> find_pipes(std::span<const InterfaceShape> interfaces,
                                const PipeRequirements& required) {
  for (const InterfaceShape& shape : interfaces) {
    if (!fits(required.usb_class, shape.usb_class) ||
        !fits(required.usb_subclass, shape.usb_subclass) ||
        !fits(required.usb_protocol, shape.usb_protocol)) {
      continue;
    }
    const EndpointShape* in = find_endpoint(shape, required, kTowardsHost);
    const EndpointShape* out = required.needs_out ? find_endpoint(shape, required, 0) : nullptr;
    if (in == nullptr || (required.needs_out && out == nullptr)) continue;
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
