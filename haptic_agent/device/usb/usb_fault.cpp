// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/usb/usb_fault.h"

#include <libusb-1.0/libusb.h>

#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {
namespace {

std::string_view sentence_of(UsbFault fault) {
  switch (fault) {
    case UsbFault::kNotFound:
      return "is not plugged in or not switched on";
    case UsbFault::kPermission:
      return "is plugged in, but this user has no permission to open it: as root, copy "
             "haptic_agent/70-kerf.rules to /etc/udev/rules.d/, run 'udevadm control --reload' and "
             "'udevadm trigger', then plug it in again";
    case UsbFault::kBusy:
      return "is in use by another program or driver: close it (another kerf-agent, spacenavd, a "
             "vendor's driver)";
    case UsbFault::kWrongDevice:
      return "does not match its USB ids";
    case UsbFault::kUnplugged:
      return "has been unplugged";
    case UsbFault::kStall:
      return "rejected a request (stall)";
    case UsbFault::kOverflow:
      return "sent more data than its packet size (babble)";
    case UsbFault::kTimeout:
      return "does not respond";
    case UsbFault::kIo:
      break;
  }
  return "reported an input/output error; try another cable or port";
}

}  // namespace

UsbError usb_error(UsbFault fault, std::string_view device, std::string_view detail) {
  std::string text = join({"the ", device, " ", sentence_of(fault)});
  if (!detail.empty()) text += join({" (", detail, ")"});
  return {.fault = fault, .text = std::move(text)};
}

UsbFault fault_of(int libusb_code) noexcept {
  switch (libusb_code) {
    case LIBUSB_ERROR_ACCESS:
      return UsbFault::kPermission;
    case LIBUSB_ERROR_NO_DEVICE:
      return UsbFault::kUnplugged;
    case LIBUSB_ERROR_NOT_FOUND:
      return UsbFault::kNotFound;
    case LIBUSB_ERROR_BUSY:
      return UsbFault::kBusy;
    case LIBUSB_ERROR_TIMEOUT:
      return UsbFault::kTimeout;
    case LIBUSB_ERROR_OVERFLOW:
      return UsbFault::kOverflow;
    case LIBUSB_ERROR_PIPE:
      return UsbFault::kStall;
    default:
      return UsbFault::kIo;
  }
}

}  // namespace kerf::agent
