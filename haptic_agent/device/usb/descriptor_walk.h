// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "haptic_agent/device/usb/endpoints.h"

struct libusb_device;

namespace kerf::agent {

/// Returns all alternate settings of all interfaces of the active configuration, or of the first
/// one if the active one is unknown. Empty if the descriptors cannot be read.
std::vector<InterfaceShape> walk_descriptors(libusb_device* device);

}  // namespace kerf::agent
