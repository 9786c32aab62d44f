// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/usb/descriptor_walk.h"

#include <libusb-1.0/libusb.h>

#include <memory>

namespace kerf::agent {
namespace {

constexpr std::uint8_t kKindMask = 0x03;
/// The bits of wMaxPacketSize above this mask count additional packets per microframe.
constexpr std::uint16_t kPacketBytesMask = 0x07FF;

InterfaceShape shape_of(const libusb_interface_descriptor& setting) {
  InterfaceShape shape{.number = setting.bInterfaceNumber,
                       .alternate = setting.bAlternateSetting,
                       .usb_class = setting.bInterfaceClass,
                       .usb_subclass = setting.bInterfaceSubClass,
                       .usb_protocol = setting.bInterfaceProtocol};
  // For truncated descriptors, libusb keeps the endpoint count without the endpoints.
  const int count = setting.endpoint != nullptr ? setting.bNumEndpoints : 0;
  for (int i = 0; i < count; ++i) {
    const libusb_endpoint_descriptor& endpoint = setting.endpoint[i];
    shape.endpoints.push_back({.address = endpoint.bEndpointAddress,
                               .kind = static_cast<std::uint8_t>(endpoint.bmAttributes & kKindMask),
                               .max_packet_bytes = static_cast<std::uint16_t>(
                                   endpoint.wMaxPacketSize & kPacketBytesMask)});
  }
  return shape;
}

}  // namespace

std::vector<InterfaceShape> walk_descriptors(libusb_device* device) {
  libusb_config_descriptor* found = nullptr;
  if (libusb_get_active_config_descriptor(device, &found) != 0 &&
      libusb_get_config_descriptor(device, 0, &found) != 0) {
    return {};
  }
  const std::unique_ptr<libusb_config_descriptor, decltype(&libusb_free_config_descriptor)> config(
      found, libusb_free_config_descriptor);
  std::vector<InterfaceShape> shapes;
  for (int i = 0; i < config->bNumInterfaces; ++i) {
    const libusb_interface& settings = config->interface[i];
    const int count = settings.altsetting != nullptr ? settings.num_altsetting : 0;
    for (int j = 0; j < count; ++j) {
      shapes.push_back(shape_of(settings.altsetting[j]));
    }
  }
  return shapes;
}

}  // namespace kerf::agent
