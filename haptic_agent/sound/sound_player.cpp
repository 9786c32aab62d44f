// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/sound/sound_player.h"

#include <array>
#include <chrono>
#include <utility>

namespace kerf::agent {
namespace {

/// 10 ms.
constexpr std::size_t kBlockSamples = kSoundHz / 100;
/// The card sets the pace in the rest of a block's time. A device without a pace, such as "null",
/// gets blocks at this one.
constexpr std::chrono::milliseconds kPause{9};
/// Number of blocks without a value after which the servo counts as ended or stalled.
constexpr int kStaleBlocks = 20;

}  // namespace

SoundPlayer::SoundPlayer(SoundCard opened, const Spindle& spindle, LatestValue<HeardCut>& heard)
    : thread_([card = std::move(opened), spindle, &heard](const std::stop_token& stop) mutable {
        Synthesizer synthesizer(kSoundHz);
        std::array<float, kBlockSamples> samples{};
        HeardCut cut;
        int silent_blocks = 0;
        while (!stop.stop_requested()) {
          silent_blocks = heard.read(cut) ? 0 : silent_blocks + 1;
          if (silent_blocks > kStaleBlocks) cut = {};
          synthesizer.render(sound_of(spindle, cut), samples);
          if (!card.write(samples)) return;
          std::this_thread::sleep_for(kPause);
        }
      }) {}

SoundPlayer::~SoundPlayer() {
  thread_.request_stop();
  thread_.join();
}

}  // namespace kerf::agent
