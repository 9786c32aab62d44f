// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/falcon/falcon_frame.h"

#include <algorithm>
#include <cmath>

namespace kerf::agent::falcon {
namespace {

constexpr std::uint8_t kBegin = '<';
constexpr std::uint8_t kEnd = '>';
constexpr std::uint8_t kBase = 'A';
constexpr std::size_t kFlagsAt = 13;
constexpr double kWordsPerNmm = 10.0;
constexpr int kHomedShift = 4;

void put_word(Frame& frame, std::size_t at, std::int16_t value) noexcept {
  const auto bits = static_cast<std::uint16_t>(value);
  for (std::size_t i = 0; i < 4; ++i) {
    frame[at + i] = static_cast<std::uint8_t>(kBase + ((bits >> (4 * i)) & 0xF));
  }
}

/// Returns nullopt if a byte is not one of the sixteen letters.
std::optional<std::int16_t> take_word(std::span<const std::uint8_t> frame,
                                      std::size_t at) noexcept {
  unsigned bits = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const int nibble = frame[at + i] - kBase;
    if (nibble < 0 || nibble > 0xF) return std::nullopt;
    bits |= static_cast<unsigned>(nibble) << (4 * i);
  }
  return static_cast<std::int16_t>(bits);
}

Frame empty_frame() noexcept {
  Frame frame{};
  frame.fill(kBase);
  frame.front() = kBegin;
  frame.back() = kEnd;
  return frame;
}

struct Words {
  std::array<std::int16_t, 3> words{};
  std::uint8_t flags = 0;
};

std::optional<Words> decode(std::span<const std::uint8_t> frame) noexcept {
  if (frame.size() != kFrameBytes || frame.front() != kBegin || frame.back() != kEnd) {
    return std::nullopt;
  }
  Words decoded;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto word = take_word(frame, 1 + 4 * i);
    if (!word) return std::nullopt;
    decoded.words[i] = *word;
  }
  if (frame[kFlagsAt] < kBase) return std::nullopt;
  decoded.flags = static_cast<std::uint8_t>(frame[kFlagsAt] - kBase);
  return decoded;
}

Frame encode(const std::array<std::int16_t, 3>& words, std::uint8_t flags) noexcept {
  Frame frame = empty_frame();
  for (std::size_t i = 0; i < 3; ++i) put_word(frame, 1 + 4 * i, words[i]);
  frame[kFlagsAt] = static_cast<std::uint8_t>(kBase + flags);
  return frame;
}

}  // namespace

Frame encode_command(const std::array<std::int16_t, 3>& motors, std::uint8_t lights) noexcept {
  return encode(motors, lights);
}

Frame encode_state(const FalconState& state) noexcept {
  const auto flags = static_cast<std::uint8_t>(state.buttons | (state.homed << kHomedShift));
  return encode(state.encoders, flags);
}

std::optional<FalconState> decode_state(std::span<const std::uint8_t> frame) noexcept {
  const auto decoded = decode(frame);
  if (!decoded) return std::nullopt;
  return FalconState{
      .encoders = decoded->words,
      .buttons = static_cast<std::uint8_t>(decoded->flags & 0xF),
      .homed = static_cast<std::uint8_t>((decoded->flags >> kHomedShift) & kAllHomed)};
}

std::optional<FalconCommand> decode_command(std::span<const std::uint8_t> frame) noexcept {
  const auto decoded = decode(frame);
  if (!decoded) return std::nullopt;
  return FalconCommand{.motors = decoded->words, .lights = decoded->flags};
}

std::array<std::int16_t, 3> motor_words(const std::array<double, 3>& torques_nmm) noexcept {
  double most = 0;
  for (const double torque : torques_nmm) {
    if (!std::isfinite(torque)) return {};
    most = std::max(most, std::abs(torque) * kWordsPerNmm);
  }
  const double share = most > kMaxMotorWord ? kMaxMotorWord / most : 1.0;
  std::array<std::int16_t, 3> words{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto word = static_cast<int>(std::lround(-torques_nmm[i] * kWordsPerNmm * share));
    words[i] = static_cast<std::int16_t>(std::clamp(word, -kMaxMotorWord, kMaxMotorWord));
  }
  return words;
}

std::optional<Frame> FrameReader::take(std::span<const std::uint8_t> packet) noexcept {
  std::optional<Frame> newest;
  if (packet.size() <= kModemBytes) return newest;
  for (const std::uint8_t byte : packet.subspan(kModemBytes)) {
    if (byte == kBegin) filled_ = 0;
    if (filled_ == 0 && byte != kBegin) continue;
    frame_[filled_++] = byte;
    if (filled_ < kFrameBytes) continue;
    filled_ = 0;
    if (byte == kEnd) newest = frame_;
  }
  return newest;
}

}  // namespace kerf::agent::falcon
