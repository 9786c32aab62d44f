// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <thread>

#include "haptic_agent/realtime/latest_value.h"
#include "haptic_agent/sound/cut_sound.h"
#include "haptic_agent/sound/sound_card.h"

namespace kerf::agent {

/// Plays the servo's HeardCut values on an ordinary thread. The servo never waits for it. Ends
/// silently if the card is lost.
class SoundPlayer {
 public:
  /// `heard` must outlive the player. Starts at once.
  SoundPlayer(SoundCard card, const Spindle& spindle, LatestValue<HeardCut>& heard);
  ~SoundPlayer();
  SoundPlayer(const SoundPlayer&) = delete;
  SoundPlayer& operator=(const SoundPlayer&) = delete;

 private:
  std::jthread thread_;
};

}  // namespace kerf::agent
