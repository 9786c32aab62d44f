// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/usb/usb_survey.h"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <memory>

#include "haptic_agent/device/falcon/falcon_protocol.h"
#include "haptic_agent/device/reference/report.h"
#include "haptic_agent/device/spacemouse/space_report.h"
#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {
namespace {

std::string node_of(libusb_device* device) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "/dev/bus/usb/%03d/%03d", libusb_get_bus_number(device),
                libusb_get_device_address(device));
  return text.data();
}

std::optional<FoundDevice> known(libusb_device* device) {
  libusb_device_descriptor descriptor{};
  if (libusb_get_device_descriptor(device, &descriptor) != 0) return std::nullopt;
  const UsbId id{descriptor.idVendor, descriptor.idProduct};
  for (const KnownDevice& kind : known_devices()) {
    if (std::ranges::find(kind.ids, id) == kind.ids.end()) continue;
    return FoundDevice{.name = kind.name, .word = kind.word, .id = id, .node = node_of(device)};
  }
  return std::nullopt;
}

}  // namespace

const std::vector<KnownDevice>& known_devices() {
  static const std::vector<KnownDevice> kDevices = {
      {"5-DOF reference device", "usb", {{reference::kVendorId, reference::kProductId}}},
      {"Novint Falcon", "falcon", {falcon::FalconProtocol::kId}},
      {"SpaceMouse", "spacemouse", space_mouse_ids()},
      {"Force Dimension device",
       "",
       {{0x1451, 0x0301}, {0x1451, 0x0402}, {0x1451, 0x0403}, {0x1451, 0x040c}}},
      {"3D Systems Touch", "", {{0x2988, 0x0302}, {0x2988, 0x0304}}}};
  return kDevices;
}

std::expected<std::vector<FoundDevice>, std::string> survey_usb() {
  libusb_context* raw = nullptr;
  if (const int code = libusb_init(&raw); code != 0) {
    return std::unexpected(join({"USB is not available: ", libusb_strerror(code)}));
  }
  const std::unique_ptr<libusb_context, decltype(&libusb_exit)> context(raw, libusb_exit);
  libusb_device** list = nullptr;
  const auto count = libusb_get_device_list(context.get(), &list);
  std::vector<FoundDevice> found;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    auto device = known(list[i]);
    if (!device) continue;
    libusb_device_handle* handle = nullptr;
    if (const int code = libusb_open(list[i], &handle); code != 0) device->fault = fault_of(code);
    if (handle != nullptr) libusb_close(handle);
    found.push_back(*std::move(device));
  }
  if (count >= 0) libusb_free_device_list(list, 1);
  return found;
}

}  // namespace kerf::agent
