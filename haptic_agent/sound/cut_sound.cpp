// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/sound/cut_sound.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::agent {
namespace {

constexpr double kSPerMin = 60;
constexpr double kToneMinHz = 60, kToneMaxHz = 4000;
constexpr double kNoiseMinHz = 500, kNoiseMaxHz = 8000;
/// Ratio of the center frequency of the chips' noise to the tone.
constexpr double kNoiseOverTone = 4;
/// Gains: of a free spindle, and the greatest ones of a cut.
constexpr double kFreeGain = 0.02, kToneGain = 0.12, kNoiseGain = 0.25;
/// Force and removal rate at which their factors are one half.
constexpr double kHalfN = 10, kHalfMm3PerS = 100;
constexpr double kSmoothingS = 0.05;
constexpr double kNoiseQ = 0.8;
/// A gain that fades below this becomes zero: less than a step of 16 bits.
constexpr double kInaudible = 1e-5;

/// Returns the correction of a sawtooth around its jump that makes the step band-limited (T.
/// Stilson, J. Smith, "Alias-free digital synthesis of classic analog waveforms", 1996, with a
/// polynomial of two samples).
double rounded_jump(double phase, double step) {
  if (phase < step) {
    const double t = phase / step;
    return t + t - t * t - 1;
  }
  if (phase > 1 - step) {
    const double t = (phase - 1) / step;
    return t * t + t + t + 1;
  }
  return 0;
}

}  // namespace

SoundLevels sound_of(const Spindle& spindle, const HeardCut& cut) {
  const double tone_hz = std::clamp(spindle.rpm / kSPerMin * spindle.teeth, kToneMinHz, kToneMaxHz);
  SoundLevels levels{.tone_hz = tone_hz,
                     .noise_hz = std::clamp(kNoiseOverTone * tone_hz, kNoiseMinHz, kNoiseMaxHz)};
  if (!cut.running) return levels;
  const double force = cut.force_n / (cut.force_n + kHalfN);
  const double removal = cut.removed_mm3_per_s / (cut.removed_mm3_per_s + kHalfMm3PerS);
  const double level = std::sqrt(force * removal);
  levels.tone_gain = kFreeGain + (kToneGain - kFreeGain) * level;
  levels.noise_gain = kNoiseGain * level;
  return levels;
}

double Synthesizer::sawtooth() {
  const double step = now_.tone_hz / sample_hz_;
  phase_ += step;
  phase_ -= std::floor(phase_);
  return 2 * phase_ - 1 - rounded_jump(phase_, step);
}

double Synthesizer::noise() {
  random_ = random_ * 1664525U + 1013904223U;
  const double white = random_ / 2147483648.0 - 1;
  const double filtered = center_gain_ * (white - in_[1]) - back_[0] * out_[0] - back_[1] * out_[1];
  in_[1] = in_[0], in_[0] = white;
  out_[1] = out_[0], out_[0] = filtered;
  return filtered;
}

void Synthesizer::render(const SoundLevels& levels, std::span<float> samples) {
  // A silent synthesizer starts at the new frequencies directly.
  const bool silent = now_.tone_gain == 0 && now_.noise_gain == 0;
  now_.tone_hz = silent ? levels.tone_hz : now_.tone_hz;
  now_.noise_hz = levels.noise_hz;
  // A band-pass of gain 1 at its center (R. Bristow-Johnson, "Audio EQ cookbook").
  const double angle = 2 * std::numbers::pi * now_.noise_hz / sample_hz_;
  const double width = std::sin(angle) / (2 * kNoiseQ);
  center_gain_ = width / (1 + width);
  back_[0] = -2 * std::cos(angle) / (1 + width);
  back_[1] = (1 - width) / (1 + width);
  const double share = 1 - std::exp(-1 / (sample_hz_ * kSmoothingS));
  const auto approach = [share](double& value, double target) {
    value += (target - value) * share;
    if (target == 0 && value < kInaudible) value = 0;
  };
  for (float& sample : samples) {
    approach(now_.tone_hz, levels.tone_hz);
    approach(now_.tone_gain, levels.tone_gain);
    approach(now_.noise_gain, levels.noise_gain);
    const double sum = now_.tone_gain * sawtooth() + now_.noise_gain * noise();
    sample = static_cast<float>(std::clamp(sum, -1.0, 1.0));
  }
}

}  // namespace kerf::agent
