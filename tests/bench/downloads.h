// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <stop_token>
#include <thread>

#include "tests/bench/live_client.h"

namespace kerf::bench {

/// Downloads the surface of the session "bench" repeatedly.
class Downloads {
 public:
  Downloads(std::uint16_t port, bool on) {
    if (!on) return;
    thread_ = std::jthread([this, port](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        const bool is_refused = get(port, "/v1/sessions/bench/model.stl").starts_with('{');
        if (!is_refused) ++count_;
        std::this_thread::sleep_for(std::chrono::milliseconds(is_refused ? 20 : 0));
      }
    });
  }
  /// Returns the number of complete downloads.
  int count() const { return count_; }

 private:
  std::atomic<int> count_ = 0;
  std::jthread thread_;
};

}  // namespace kerf::bench
