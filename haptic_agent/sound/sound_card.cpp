// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/sound/sound_card.h"

#include <dlfcn.h>

#include <utility>

namespace kerf::agent {
namespace {

// From ALSA's pcm.h, whose values are part of its binary interface.
constexpr int kPlayback = 0;
constexpr int kFloatLittleEndian = 14;
constexpr int kInterleaved = 3;
constexpr unsigned kChannels = 1;
constexpr int kResample = 1;
/// Length of the card's buffer: a shorter one is heard sooner, a longer one bridges a busy machine.
constexpr unsigned kLatencyUs = 60'000;
constexpr int kQuietly = 1;

/// Error handler for ALSA, which otherwise prints a page of causes on standard error. The agent
/// reports one sentence.
using ErrorHandler = void(const char* file, int line, const char* function, int error,
                          const char* format, ...);
void ignore_error(const char*, int, const char*, int, const char*, ...) {}

}  // namespace

/// The used functions of ALSA, and an open device.
struct SoundCard::Pcm {
  int (*handle_errors)(ErrorHandler*);
  int (*open)(void**, const char*, int, int);
  int (*set_params)(void*, int, int, unsigned, unsigned, int, unsigned);
  long (*write)(void*, const void*, unsigned long);
  int (*recover)(void*, int, int);
  int (*close)(void*);
  const char* (*reason)(int);
  void* device = nullptr;
};

void SoundCard::Close::operator()(Pcm* pcm) const {
  if (pcm->device != nullptr) pcm->close(pcm->device);
  delete pcm;
}

std::expected<SoundCard, std::string> SoundCard::open(const std::string& device,
                                                      const char* library) {
  void* const loaded = ::dlopen(library, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (loaded == nullptr) {
    return std::unexpected(std::string(library) +
                           " is not on this machine (Debian: package libasound2)");
  }
  SoundCard card(new Pcm{});
  Pcm& pcm = *card.pcm_;
  const auto find = [&]<typename F>(F& function, const char* name) {
    function = reinterpret_cast<F>(::dlsym(loaded, name));
    return function != nullptr;
  };
  if (!find(pcm.handle_errors, "snd_lib_error_set_handler") || !find(pcm.open, "snd_pcm_open") ||
      !find(pcm.set_params, "snd_pcm_set_params") || !find(pcm.write, "snd_pcm_writei") ||
      !find(pcm.recover, "snd_pcm_recover") || !find(pcm.close, "snd_pcm_close") ||
      !find(pcm.reason, "snd_strerror")) {
    return std::unexpected(std::string(library) + " is not ALSA's");
  }
  pcm.handle_errors(ignore_error);
  const auto failed = [&](int error) {
    return std::unexpected("ALSA's device \"" + device + "\": " + pcm.reason(error) +
                           " (aplay -L lists devices)");
  };
  if (const int error = pcm.open(&pcm.device, device.c_str(), kPlayback, 0); error < 0) {
    pcm.device = nullptr;
    return failed(error);
  }
  if (const int error = pcm.set_params(pcm.device, kFloatLittleEndian, kInterleaved, kChannels,
                                       kSoundHz, kResample, kLatencyUs);
      error < 0) {
    return failed(error);
  }
  return card;
}

bool SoundCard::write(std::span<const float> samples) {
  while (!samples.empty()) {
    long written = pcm_->write(pcm_->device, samples.data(), samples.size());
    if (written < 0) {
      if (pcm_->recover(pcm_->device, static_cast<int>(written), kQuietly) < 0) return false;
      written = 0;
    }
    samples = samples.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace kerf::agent
