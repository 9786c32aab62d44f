// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "haptic_agent/device/usb/endpoints.h"

struct libusb_device;

namespace kerf::agent {

/// Every alternate setting of every interface of the active configuration (of the first one, where
/// the system does not tell); empty if the descriptors cannot be read.
std::vector<InterfaceShape> walk_descriptors(libusb_device* device);

}  // namespace kerf::agent
