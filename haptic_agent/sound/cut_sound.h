// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "haptic_agent/servo/heard_cut.h"

namespace kerf::agent {

/// The spindle that a scene's force law states, or a typical one.
struct Spindle {
  double rpm = 12000;
  int teeth = 2;
};

/// Frequencies in Hz; gains from 0 to 1.
struct SoundLevels {
  double tone_hz = 0, tone_gain = 0;
  double noise_hz = 0, noise_gain = 0;
};

/// Returns the sound of a cut, like the viewer's (web/src/model/sound.ts): a tone at the
/// tooth-passing frequency, and the noise of chips, which follow force and removal rate. Contact
/// (force without removal) and an imprint (removal without force) leave the tone of a free spindle.
/// Silent unless the spindle runs.
SoundLevels sound_of(const Spindle& spindle, const HeardCut& cut);

/// Turns levels into samples: a sawtooth without aliases, and white noise through a band-pass.
/// Levels change within 50 ms to avoid clicks. Deterministic.
class Synthesizer {
 public:
  explicit Synthesizer(double sample_hz) : sample_hz_(sample_hz) {}

  /// Writes the next samples, each in [-1, 1], while approaching `levels`. Exactly zero once both
  /// gains have faded.
  void render(const SoundLevels& levels, std::span<float> samples);

 private:
  double sawtooth();
  double noise();

  double sample_hz_;
  SoundLevels now_;
  double phase_ = 0;  ///< phase of the sawtooth, in turns
  std::uint32_t random_ = 1;
  double in_[2] = {}, out_[2] = {};  ///< past samples of the band-pass
  double center_gain_ = 0, back_[2] = {};
};

}  // namespace kerf::agent
