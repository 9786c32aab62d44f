// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptic_agent/device/carving_figure.h"
#include "haptic_agent/device/pose_script.h"
#include "haptic_agent/device/reference/report.h"
#include "haptic_agent/device/simulated_hand.h"
#include "haptic_agent/device/usb/usb_protocol.h"

namespace kerf::agent {

enum class DeviceKind { kSimulated, kReplay, kReference, kFalcon, kSpaceMouse };

/// What `--device` asks for, its file already read.
struct DeviceChoice {
  DeviceKind kind = DeviceKind::kSimulated;
  /// Empty: the figure that the simulated hand carves by itself.
  std::optional<PoseScript> script{};
  /// Of a reference device that a builder gave ids of its own.
  UsbId usb_id{reference::kVendorId, reference::kProductId};
  /// The Falcon's; empty: it must run one already.
  std::vector<std::uint8_t> firmware{};
};

/// Reads `sim[:FILE]`, `replay:FILE`, `usb[:VENDOR:PRODUCT]` (ids in hexadecimal),
/// `falcon[:FIRMWARE_FILE]` or `spacemouse`. The error is one sentence, with file and line where
/// there is one.
std::expected<DeviceChoice, std::string> choose_device(std::string_view text);

/// What the session decides about a device.
struct DevicePlace {
  StockBox stock{};
  double pivot_mm = 60;
  std::uint32_t participant = 0;
};

struct DeviceOptions {
  bool loop = false;
  double speed = 1.0;
  double stiffness_n_per_mm = HandSettings{}.stiffness_n_per_mm;
  /// Told by a USB device, on its thread, what keeps it from being ready, and when it is.
  std::function<void(const std::string&)> notice{};
};

/// Makes the device. A USB device need not be plugged in yet: it looks for itself until it is. The
/// middle of its workspace lies on the middle of the stock's top.

std::unique_ptr<HapticDevice> make_device(const DeviceChoice& choice, const DevicePlace& place,
                                          const DeviceOptions& options);

}  // namespace kerf::agent
