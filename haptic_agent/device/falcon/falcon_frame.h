// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace kerf::agent::falcon {

inline constexpr std::size_t kFrameBytes = 16;
/// A packet of the USB bridge, and the modem status with which each packet of its answer begins.
inline constexpr std::uint16_t kPacketBytes = 64;
inline constexpr std::size_t kModemBytes = 2;
/// Largest motor word. The vendor's program uses no larger ones, and values beyond the field's 16
/// bits would reverse the force.
inline constexpr int kMaxMotorWord = 4096;

inline constexpr std::uint8_t kHomingMode = 0x1;
inline constexpr std::uint8_t kGreenLight = 0x2;
inline constexpr std::uint8_t kBlueLight = 0x4;
inline constexpr std::uint8_t kRedLight = 0x8;

inline constexpr std::uint8_t kCenterButton = 0x4;
/// The three buttons around the center.
inline constexpr std::uint8_t kSmallButtons = 0xB;
inline constexpr std::uint8_t kAllHomed = 0x7;

/// The Falcon's answer to a command.
struct FalconState {
  std::array<std::int16_t, 3> encoders{};
  /// Bits: 1 plus, 2 forward, 4 center, 8 minus.
  std::uint8_t buttons = 0;
  /// One bit per leg. The encoders are valid only if all three are set.
  std::uint8_t homed = 0;

  bool operator==(const FalconState&) const = default;
};

using Frame = std::array<std::uint8_t, kFrameBytes>;

/// Encodes '<', three motor words of four nibbles each (lowest first, each plus 'A'), lights and
/// mode, 'A', '>'.
Frame encode_command(const std::array<std::int16_t, 3>& motors, std::uint8_t lights) noexcept;
/// Encodes an answer. Used by models of the device.
Frame encode_state(const FalconState& state) noexcept;
std::optional<FalconState> decode_state(std::span<const std::uint8_t> frame) noexcept;
struct FalconCommand {
  std::array<std::int16_t, 3> motors{};
  std::uint8_t lights = 0;
};
std::optional<FalconCommand> decode_command(std::span<const std::uint8_t> frame) noexcept;

/// Converts leg torques, N·mm, to motor words, -10000 per N·m. If a word exceeds kMaxMotorWord, all
/// are scaled by one factor, so that the force keeps its direction. Returns zeros if a torque is
/// not finite.
std::array<std::int16_t, 3> motor_words(const std::array<double, 3>& torques_nmm) noexcept;

/// Assembles frames from packets. Skips the two bytes of modem status at the start of every packet,
/// and all bytes outside frames.
class FrameReader {
 public:
  /// Adds one USB packet and returns the newest frame that it completed, if any.
  std::optional<Frame> take(std::span<const std::uint8_t> packet) noexcept;
  void reset() noexcept { filled_ = 0; }

 private:
  Frame frame_{};
  std::size_t filled_ = 0;
};

}  // namespace kerf::agent::falcon
