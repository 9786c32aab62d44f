// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace kerf::agent::falcon {

inline constexpr std::size_t kFrameBytes = 16;
/// The motors' words that the wire is trusted with: the vendor's own program used no more, and the
/// field has 16 bits, beyond which a strong push would turn into a pull.
inline constexpr int kMostMotorWord = 4096;

inline constexpr std::uint8_t kHomingMode = 0x1;
inline constexpr std::uint8_t kGreenLight = 0x2;
inline constexpr std::uint8_t kBlueLight = 0x4;
inline constexpr std::uint8_t kRedLight = 0x8;

inline constexpr std::uint8_t kCentreButton = 0x4;
inline constexpr std::uint8_t kAllHomed = 0x7;

/// What the Falcon answers to each command.
struct FalconState {
  std::array<std::int16_t, 3> encoders{};
  /// Bits: 1 plus, 2 forward, 4 centre, 8 minus.
  std::uint8_t buttons = 0;
  /// One bit a leg; encoders mean nothing before all three are set.
  std::uint8_t homed = 0;

  bool operator==(const FalconState&) const = default;
};

using Frame = std::array<std::uint8_t, kFrameBytes>;

/// '<', three motor words of four nibbles each (lowest first, each plus 'A'), lights and mode, 'A',
/// '>'.
Frame encode_command(const std::array<std::int16_t, 3>& motors, std::uint8_t lights) noexcept;
/// The same from the other side; for models of the device.
Frame encode_state(const FalconState& state) noexcept;
std::optional<FalconState> decode_state(std::span<const std::uint8_t> frame) noexcept;
struct FalconCommand {
  std::array<std::int16_t, 3> motors{};
  std::uint8_t lights = 0;
};
std::optional<FalconCommand> decode_command(std::span<const std::uint8_t> frame) noexcept;

/// Motor words of leg torques, N·mm: -10000 a N·m, all shortened by one factor if one exceeds the
/// wire, so that the force keeps its direction. A number that is not finite gives zeros.
std::array<std::int16_t, 3> motor_words(const std::array<double, 3>& torques_nmm) noexcept;

/// Puts frames together from packets: drops the two bytes of modem status that the serial chip puts
/// before every packet, and whatever does not belong to a frame.
class FrameReader {
 public:
  /// Takes one USB packet; the newest whole frame that it completed, or nothing.
  std::optional<Frame> take(std::span<const std::uint8_t> packet) noexcept;
  void reset() noexcept { filled_ = 0; }

 private:
  Frame frame_{};
  std::size_t filled_ = 0;
};

}  // namespace kerf::agent::falcon
