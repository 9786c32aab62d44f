#pragma once

#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "haptic_agent/device/carving_figure.h"
#include "haptic_agent/device/pose_script.h"
#include "haptic_agent/device/simulated_hand.h"

namespace kerf::agent {

enum class DeviceKind { kSimulated, kReplay };

/// What `--device` asks for, its file already read.
struct DeviceChoice {
  DeviceKind kind = DeviceKind::kSimulated;
  /// Empty: the figure that the simulated hand carves by itself.
  std::optional<PoseScript> script;
};

/// Reads `sim`, `sim:FILE` or `replay:FILE`. The error is one sentence, with file and line where
/// there is one; it is honest about the devices that are not built yet.
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
};

std::unique_ptr<HapticDevice> make_device(const DeviceChoice& choice, const DevicePlace& place,
                                          const DeviceOptions& options);

}  // namespace kerf::agent
