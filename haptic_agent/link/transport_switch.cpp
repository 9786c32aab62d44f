// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/link/transport_switch.h"

#include <algorithm>
#include <utility>

namespace kerf::agent {

void TransportSwitch::begin(bool offered, std::uint64_t now_us) noexcept {
  offered_ = probing_ = offered;
  over_udp_ = answered_ = false;
  probes_ = 0;
  next_probe_us_ = now_us;
  pause_us_ = kFirstPauseUs;
}

bool TransportSwitch::probe_due(std::uint64_t now_us) noexcept {
  if (!offered_ || now_us < next_probe_us_) return false;
  next_probe_us_ = now_us + kProbeEveryUs;
  probing_ = true;
  ++probes_;
  return true;
}

void TransportSwitch::pause(std::uint64_t now_us) noexcept {
  probing_ = answered_ = over_udp_ = false;
  probes_ = 0;
  next_probe_us_ = now_us + pause_us_;
  pause_us_ = std::min(2 * pause_us_, kLongestPauseUs);
}

bool TransportSwitch::update(std::uint64_t now_us, bool ready, std::uint64_t stuck_us,
                             std::uint64_t rtt_us) {
  if (!offered_) return false;
  if (over_udp_) {
    if (now_us - since_us_ > kGoodUs) pause_us_ = kFirstPauseUs;
    if (stuck_us <= kSilenceUs + rtt_us) return false;
    pause(now_us);
    ++fell_back_;
    if (!std::exchange(notified_silent_, true))
      notice_ = "UDP has gone silent, back on the WebSocket";
    return true;
  }
  if (answered_ && ready) {
    over_udp_ = true;
    since_us_ = now_us;
    ++taken_over_;
  } else if (!answered_ && probes_ >= kProbes && now_us >= next_probe_us_) {
    pause(now_us);
    if (taken_over_ == 0 && !std::exchange(notified_blocked_, true)) {
      notice_ = "no answer over UDP, staying on the WebSocket";
    }
  }
  return false;
}

std::string TransportSwitch::take_notice() { return std::exchange(notice_, {}); }

}  // namespace kerf::agent
