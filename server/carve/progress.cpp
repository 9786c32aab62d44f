// SPDX-License-Identifier: Apache-2.0
#include "server/carve/progress.h"

#include <unistd.h>

#include <algorithm>
#include <iostream>

namespace kerf {
namespace {

constexpr int kBarWidth = 40;
constexpr std::chrono::milliseconds kRedraw{100};

}  // namespace

Progress::Progress() : terminal_(::isatty(STDERR_FILENO) == 1) {}

void Progress::show(const std::string& phase, double share) {
  if (!terminal_) return;
  const auto now = Clock::now();
  if (now < next_ && phase == phase_) return;
  next_ = now + kRedraw;
  phase_ = phase;
  const double part = std::clamp(share, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(part * kBarWidth);
  std::cerr << "\r\033[K" << phase << " [" << std::string(filled, '#')
            << std::string(kBarWidth - filled, ' ') << "] " << static_cast<int>(part * 100) << " %"
            << std::flush;
  drawn_ = true;
}

void Progress::clear() {
  if (drawn_) std::cerr << "\r\033[K" << std::flush;
  drawn_ = false;
}

}  // namespace kerf
