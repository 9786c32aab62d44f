// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "haptic_agent/device/reference/pen.h"

namespace kerf::agent::reference {

/// Messages of the protocol; README.md in this folder has their layouts. Numbers are little-endian.
inline constexpr std::uint16_t kVendorId = 0x1209;
inline constexpr std::uint16_t kProductId = 0x0001;
inline constexpr std::uint8_t kUsbClass = 0xFF;
inline constexpr std::uint8_t kUsbSubclass = 0x4B;
inline constexpr std::uint8_t kUsbProtocol = 0x01;
inline constexpr std::uint8_t kVersion = 1;
inline constexpr std::uint8_t kIdentityRequest = 0x01;
/// Vendor request to the interface, device to host.
inline constexpr std::uint8_t kIdentityRequestType = 0xC1;
/// Largest accepted watchdog timeout of a device.
inline constexpr unsigned kWatchdogMs = 20;

inline constexpr std::size_t kIdentityBytes = 84;
inline constexpr std::size_t kStateBytes = 48;
inline constexpr std::size_t kCommandBytes = 24;

/// Bits of StateReport::status.
inline constexpr std::uint16_t kHomedMask = 0x003F;
inline constexpr std::uint16_t kHomingBit = 1U << 6;
inline constexpr std::uint16_t kMotorsOnBit = 1U << 7;
inline constexpr std::uint16_t kWatchdogBit = 1U << 8;
inline constexpr std::uint16_t kTooHotBit = 1U << 9;
inline constexpr std::uint16_t kOverCurrentBit = 1U << 10;
inline constexpr std::uint16_t kEmergencyStopBit = 1U << 11;

/// Bits of StateReport::buttons.
inline constexpr std::uint16_t kCutButton = 1;
inline constexpr std::uint16_t kGripSensor = 2;
/// Second button. Only some pens have it.
inline constexpr std::uint16_t kClutchButton = 4;

/// Bits of CommandReport::command.
inline constexpr std::uint16_t kEnableMotors = 1;
inline constexpr std::uint16_t kStartHoming = 2;

/// Identity and dimensions of the device. Read once by kIdentityRequest.
struct Identity {
  std::uint8_t version = kVersion;
  std::uint8_t minor = 0;
  std::uint16_t firmware = 0;
  std::uint32_t serial = 0;
  PenShape pen{};
  /// Largest torque of each motor, N·mm.
  std::array<double, 6> torque_max_nmm{};
  std::uint16_t period_us = 0;
  std::uint16_t watchdog_ms = 0;
};

/// Device to host, every period.
struct StateReport {
  std::uint16_t sequence = 0;
  std::uint32_t time_us = 0;
  std::uint16_t status = 0;
  std::uint16_t buttons = 0;
  /// Microradians, front arm first.
  std::array<std::int32_t, 6> angles_urad{};
  /// Sequence of the last accepted command, and the number of rejected ones.
  std::uint16_t accepted = 0;
  std::uint16_t rejected = 0;
  std::int16_t temperature_dc = 0;

  bool operator==(const StateReport&) const = default;
};

/// Host to device.
struct CommandReport {
  std::uint16_t sequence = 0;
  std::uint16_t command = 0;
  /// Tenths of N·mm, front arm first.
  std::array<std::int16_t, 6> torques_dnmm{};

  bool operator==(const CommandReport&) const = default;
};

/// CRC-32 of IEEE 802.3 (zlib's crc32).
std::uint32_t crc32(std::span<const std::uint8_t> bytes) noexcept;

std::array<std::uint8_t, kIdentityBytes> encode(const Identity& identity) noexcept;
std::array<std::uint8_t, kStateBytes> encode(const StateReport& report) noexcept;
std::array<std::uint8_t, kCommandBytes> encode(const CommandReport& report) noexcept;

/// Returns nullopt if the length, kind, version or checksum is wrong. An identity of another
/// version is returned, so that it can be reported, but its fields after `minor` are not valid.
std::optional<Identity> decode_identity(std::span<const std::uint8_t> bytes) noexcept;
std::optional<StateReport> decode_state(std::span<const std::uint8_t> bytes) noexcept;
std::optional<CommandReport> decode_command(std::span<const std::uint8_t> bytes) noexcept;

PenAngles angles_of(const StateReport& report) noexcept;

/// Converts torques to 0.1 N·mm. One factor scales all of them so that none exceeds its motor's
/// limit or the field's range, which keeps the direction of the wrench. Returns zeros if a torque
/// is not finite.
std::array<std::int16_t, 6> wire_torques(const std::array<double, 6>& torques_nmm,
                                         const std::array<double, 6>& most_nmm) noexcept;

}  // namespace kerf::agent::reference
