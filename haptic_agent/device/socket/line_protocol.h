// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "haptic_agent/device/carving_figure.h"
#include "haptic_agent/device/haptic_device.h"

namespace kerf::agent {

/// Messages of the line protocol of README.md in this folder, without the newline. Input from the
/// device is untrusted.
inline constexpr int kLineProtocolVersion = 1;
/// Longest accepted line.
inline constexpr std::size_t kMaxLineBytes = 1024;

struct SocketPose {
  DeviceState state;
  /// Number of the newest wrench that the device has accepted, or 0 before the first.
  std::uint16_t accepted = 0;
};

/// Reads `kerf-device 1 KEY=VALUE ...`. The error is one clause.
std::expected<DeviceCapabilities, std::string> parse_device_line(std::string_view line);

/// Reads `pose STATE X Y Z AX AY AZ BUTTONS ACCEPTED`. Returns nullopt if it is malformed.
std::optional<SocketPose> parse_pose_line(std::string_view line, bool has_deadman,
                                          std::uint64_t now_us) noexcept;

/// A device sends this line when its user re-arms after a trip.
inline constexpr std::string_view kRearmLine = "rearm";

/// `session PARTICIPANT PIVOT X0 Y0 Z0 X1 Y1 Z1`, with a newline.
std::string session_line(const StockBox& stock, double pivot_mm, std::uint32_t participant);

/// Writes and returns `wrench NUMBER FX FY FZ TX TY TZ`, with a newline. Does not allocate.
std::string_view write_wrench_line(std::span<char, 256> line, std::uint16_t number,
                                   const Wrench& wrench) noexcept;

}  // namespace kerf::agent
