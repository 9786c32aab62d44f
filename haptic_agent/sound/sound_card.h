// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <memory>
#include <span>
#include <string>

namespace kerf::agent {

/// Sample rate of SoundCard.
inline constexpr unsigned kSoundHz = 48000;

/// A mono output of ALSA. The library is loaded when a card is opened, so neither building nor
/// running the agent requires it. PipeWire and PulseAudio offer the device "default".
class SoundCard {
 public:
  /// `device`: a PCM name of ALSA, such as "default", "hw:0" or "null". The error is one sentence.
  static std::expected<SoundCard, std::string> open(const std::string& device,
                                                    const char* library = "libasound.so.2");

  /// Writes samples in [-1, 1]; waits while the card's buffer is full. Continues after an underrun.
  /// Returns false if the card is lost.
  bool write(std::span<const float> samples);

 private:
  struct Pcm;
  struct Close {
    void operator()(Pcm* pcm) const;
  };
  explicit SoundCard(Pcm* pcm) : pcm_(pcm) {}

  std::unique_ptr<Pcm, Close> pcm_;
};

}  // namespace kerf::agent
