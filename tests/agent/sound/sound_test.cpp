// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <complex>

#include "haptic_agent/sound/sound_player.h"
#include "tests/support/test.h"

namespace kerf::agent::sound_test {
namespace {

constexpr Spindle kSpindle{.rpm = 18000, .teeth = 3};
constexpr double kToneHz = 900;
constexpr HeardCut kFree{.running = true};
constexpr HeardCut kCut{.running = true, .force_n = 12, .removed_mm3_per_s = 80};

std::vector<float> render(Synthesizer& synthesizer, const HeardCut& cut, double seconds) {
  std::vector<float> samples(static_cast<std::size_t>(seconds * kSoundHz));
  synthesizer.render(sound_of(kSpindle, cut), samples);
  return samples;
}
/// Amplitude of one frequency.
double amplitude(const std::vector<float>& samples, double hz) {
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    sum += static_cast<double>(samples[i]) *
           std::polar(1.0, -2 * std::numbers::pi * hz * static_cast<double>(i) / kSoundHz);
  }
  return 2 * std::abs(sum) / static_cast<double>(samples.size());
}
double rms(const std::vector<float>& samples) {
  double sum = 0;
  for (const double x : samples) sum += x * x;
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

// The same cases as web/test/sound.test.ts.
TEST(SoundOf, ToneIsAtTheToothPassingFrequency) {
  EXPECT_EQ(sound_of(kSpindle, kCut).tone_hz, kToneHz);
  EXPECT_EQ(sound_of({.rpm = 100, .teeth = 3}, kCut).tone_hz, 60);
  EXPECT_EQ(sound_of({.rpm = 1e6, .teeth = 3}, kCut).tone_hz, 4000);
}

TEST(SoundOf, GrowsWithForceAndRemovalRateAndIsBounded) {
  for (double HeardCut::* field : {&HeardCut::force_n, &HeardCut::removed_mm3_per_s}) {
    SoundLevels last{.tone_gain = -1, .noise_gain = -1};
    for (const double x : {0.0, 1.0, 10.0, 100.0, 1e9}) {
      HeardCut cut = kCut;
      cut.*field = x;
      const SoundLevels levels = sound_of(kSpindle, cut);
      EXPECT_GT(levels.tone_gain, last.tone_gain);
      EXPECT_GT(levels.noise_gain, last.noise_gain);
      last = levels;
    }
    EXPECT_LT(last.tone_gain + last.noise_gain, 0.4);
  }
}

TEST(SoundOf, FreeSpindleHasAToneAndAStoppedOneIsSilent) {
  const SoundLevels contact = sound_of(kSpindle, {.running = true, .force_n = 50});
  EXPECT_EQ(contact.noise_gain, 0);
  EXPECT_EQ(contact.tone_gain, 0.02);
  const SoundLevels still = sound_of(kSpindle, {.force_n = 12, .removed_mm3_per_s = 80});
  EXPECT_EQ(still.tone_gain, 0);
  EXPECT_EQ(still.noise_gain, 0);
}

TEST(Synthesizer, PlaysTheToneAndItsOvertonesOnly) {
  Synthesizer synthesizer(kSoundHz);
  render(synthesizer, kFree, 0.5);
  const std::vector<float> samples = render(synthesizer, kFree, 1);
  int rises = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) rises += samples[i - 1] < 0 && samples[i] >= 0;
  EXPECT_NEAR(rises, kToneHz, 1);
  const double tone = amplitude(samples, kToneHz);
  EXPECT_NEAR(tone, 0.02 * 2 / std::numbers::pi, 0.0002) << "as a sawtooth's first harmonic";
  EXPECT_NEAR(amplitude(samples, 2 * kToneHz), tone / 2, 0.05 * tone);
  for (const double hz : {450.0, 1350.0, 3000.0}) EXPECT_LT(amplitude(samples, hz), 0.001 * tone);
}

TEST(Synthesizer, AliasesOfAHighToneAreFaint) {
  Synthesizer synthesizer(kSoundHz);
  std::vector<float> samples(kSoundHz);
  // Without rounded jumps, the overtone of 40 kHz is heard at 8 kHz, 20 dB below the tone.
  const SoundLevels levels{.tone_hz = 4000.5, .tone_gain = 0.1, .noise_hz = 8000};
  synthesizer.render(levels, samples);
  synthesizer.render(levels, samples);
  EXPECT_LT(amplitude(samples, kSoundHz - 10 * 4000.5), 0.02 * amplitude(samples, 4000.5));
}

TEST(Synthesizer, ChipNoiseIsAroundFourTimesTheTone) {
  Synthesizer synthesizer(kSoundHz);
  const SoundLevels levels{.tone_hz = kToneHz, .noise_hz = 3600, .noise_gain = 0.2};
  std::vector<float> samples(2 * kSoundHz);
  synthesizer.render(levels, samples);
  const auto band = [&](double from_hz) {
    double power = 0;
    for (int i = 0; i < 20; ++i) {
      const double a = amplitude(samples, from_hz + 10 * i);
      power += a * a;
    }
    return power;
  };
  EXPECT_GT(band(3500), 3 * band(400));
  EXPECT_GT(band(3500), 3 * band(18000));
  EXPECT_LT(std::abs(amplitude(samples, kToneHz)), 0.01) << "no tone";
}

TEST(Synthesizer, IsExactlyZeroBeforeAndAfterACut) {
  Synthesizer synthesizer(kSoundHz);
  const auto is_zero = [](float x) { return x == 0; };
  EXPECT_TRUE(std::ranges::all_of(render(synthesizer, {}, 0.1), is_zero));
  const double cut = rms(render(synthesizer, kCut, 0.5));
  EXPECT_GT(cut, 0.01);
  const std::vector<float> fading = render(synthesizer, {}, 0.2);
  EXPECT_LT(rms({fading.end() - 100, fading.end()}), 0.05 * cut);
  render(synthesizer, {}, 0.5);
  EXPECT_TRUE(std::ranges::all_of(render(synthesizer, {}, 0.1), is_zero));
}

TEST(Synthesizer, DoesNotDependOnTheBlockSize) {
  Synthesizer whole(kSoundHz), parts(kSoundHz);
  const std::vector<float> expected = render(whole, kCut, 0.1);
  std::vector<float> got;
  for (int i = 0; i < 10; ++i) {
    const std::vector<float> part = render(parts, kCut, 0.01);
    got.insert(got.end(), part.begin(), part.end());
  }
  EXPECT_EQ(got, expected);
}

/// A file that ALSA writes instead of playing.
class SoundFile : public ::testing::Test {
 protected:
  SoundFile() {
    std::filesystem::remove(path);
    available = SoundCard::open("null").has_value();
  }
  ~SoundFile() override { std::filesystem::remove(path); }
  std::vector<float> samples() const {
    const std::string bytes = test::content_of(path);
    std::vector<float> read(bytes.size() / sizeof(float));
    std::memcpy(read.data(), bytes.data(), read.size() * sizeof(float));
    return read;
  }
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("kerf_sound_" + std::to_string(::getpid()));
  std::string device = "file:'" + path.string() + "',raw";
  bool available = false;
};

TEST_F(SoundFile, ContainsTheWrittenSamples) {
  if (!available) GTEST_SKIP() << "ALSA is not on this machine";
  Synthesizer synthesizer(kSoundHz);
  const std::vector<float> wanted = render(synthesizer, kCut, 0.1);
  {
    EXPECT_TRUE(test::value_of(SoundCard::open(device)).write(wanted));
  }
  EXPECT_EQ(samples(), wanted);
}

TEST_F(SoundFile, ReceivesTheServosCut) {
  if (!available) GTEST_SKIP() << "ALSA is not on this machine";
  LatestValue<HeardCut> heard;
  std::vector<float> played;
  // The cut fades within 0.9 s of sound, which take longer on a busy machine.
  for (int ms = 900; played.size() < kSoundHz * 9 / 10 && ms < 60'000; ms *= 2) {
    heard.write(kCut);  // no more values: the servo stalls, or has ended
    auto card = test::value_of(SoundCard::open(device));
    const auto start = std::chrono::steady_clock::now();
    {
      const SoundPlayer player(std::move(card), kSpindle, heard);
      std::this_thread::sleep_for(std::chrono::milliseconds(ms));
    }
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    played = samples();
    EXPECT_LT(static_cast<double>(played.size()), (passed.count() / 0.009 + 2) * 0.01 * kSoundHz)
        << "a device without a pace gets one";
  }
  const auto tenth = static_cast<std::ptrdiff_t>(kSoundHz / 10);
  ASSERT_GT(played.size(), kSoundHz / 2);
  EXPECT_GT(rms({played.begin(), played.begin() + tenth}), 0.005);
  EXPECT_EQ(rms({played.end() - tenth / 10, played.end()}), 0);
}

TEST(SoundCard, ErrorNamesTheMissingPart) {
  const auto error = test::error_of(SoundCard::open("null", "libno_such_sound.so.2"));
  EXPECT_EQ(error, "libno_such_sound.so.2 is not on this machine (Debian: package libasound2)");
  EXPECT_EQ(test::error_of(SoundCard::open("null", "libm.so.6")), "libm.so.6 is not ALSA's");
  if (!SoundCard::open("null")) GTEST_SKIP() << "ALSA is not on this machine";
  testing::internal::CaptureStderr();
  const auto device = SoundCard::open("no_such_device");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  ASSERT_FALSE(device);
  EXPECT_NE(device.error().find("\"no_such_device\""), std::string::npos) << device.error();
}

}  // namespace
}  // namespace kerf::agent::sound_test
