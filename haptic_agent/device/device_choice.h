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
#include "haptic_agent/device/plugin/plugin_device.h"
#include "haptic_agent/device/pose_script.h"
#include "haptic_agent/device/reference/report.h"
#include "haptic_agent/device/simulated_hand.h"
#include "haptic_agent/device/socket/line_stream.h"
#include "haptic_agent/device/usb/usb_protocol.h"

namespace kerf::agent {

enum class DeviceKind {
  kSimulated,
  kReplay,
  kReference,
  kFalcon,
  kSpaceMouse,
  kGamepad,
  kPlugin,
  kSocket
};

/// A parsed `--device` option, with its file loaded.
struct DeviceChoice {
  DeviceKind kind = DeviceKind::kSimulated;
  /// Path of a simulated hand or replay. If empty, make_carving_figure.
  std::optional<PoseScript> script{};
  /// USB ids of the reference device; builders may use their own.
  UsbId usb_id{reference::kVendorId, reference::kProductId};
  /// Firmware of the Falcon. If empty, one must be running already.
  std::vector<std::uint8_t> firmware{};
  /// Set for kPlugin.
  std::optional<Plugin> plugin{};
  /// Address of the process that serves a kSocket.
  SocketAddress socket{};
  /// Event device of a kGamepad. If empty, the first gamepad found.
  std::string node{};
};

/// Parses `sim[:FILE]`, `replay:FILE`, `usb[:VENDOR:PRODUCT]` (hexadecimal ids),
/// `falcon[:FIRMWARE_FILE]`, `spacemouse`, `gamepad[:/dev/input/eventN]`,
/// `plugin:FILE.so[:ARGUMENT]` or `socket:PATH|HOST:PORT`, and loads the file. The error is one
/// sentence, with file and line where applicable.
std::expected<DeviceChoice, std::string> choose_device(std::string_view text);

/// Parameters of a device that depend on the session.
struct DevicePlace {
  StockBox stock{};
  double pivot_mm = 60;
  std::uint32_t participant = 0;
  /// The session's tools and the initial one, for devices that change the tool.
  std::vector<std::uint32_t> tools{};
  std::uint32_t tool = 0;
};

struct DeviceOptions {
  bool loop = false;
  double speed = 1.0;
  double stiffness_n_per_mm = HandSettings{}.stiffness_n_per_mm;
  /// Called on the thread of a USB or socket device, with the reason why it is not ready, and when
  /// it is ready.
  std::function<void(const std::string&)> notice{};
};

/// Creates the device. A USB device may be plugged in later: it is searched for until found. The
/// center of the workspace is placed on the center of the stock's top. The error of a plugin or
/// socket device is one sentence.
std::expected<std::unique_ptr<HapticDevice>, std::string> make_device(const DeviceChoice& choice,
                                                                      const DevicePlace& place,
                                                                      const DeviceOptions& options);

}  // namespace kerf::agent
