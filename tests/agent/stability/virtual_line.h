// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <random>
#include <span>
#include <vector>

namespace kerf::agent {

/// Properties of a simulated network.
struct LineQuality {
  double rtt_ms = 0;
  double jitter = 0;  ///< relative variation of each delay, plus or minus
  double loss = 0;    ///< of messages
  /// Stalls for 200 ms every two seconds.
  bool bursts = false;
};

/// One direction of a TCP connection in virtual time: reliable and in order, so that a
/// retransmitted message delays all later ones.
class VirtualLine {
 public:
  VirtualLine(const LineQuality& quality, std::uint32_t seed) : quality_(quality), random_(seed) {}

  void send(std::span<const std::byte> bytes, std::uint64_t now_us) {
    std::uniform_real_distribution<double> unit(0, 1);
    const double half_us = quality_.rtt_ms * 500;
    double delay_us = half_us * (1 + quality_.jitter * (2 * unit(random_) - 1));
    // The sender learns of the gap one round trip later and retransmits.
    if (unit(random_) < quality_.loss) delay_us += 2 * half_us + kAgainUs;
    auto due_us = now_us + static_cast<std::uint64_t>(delay_us);
    if (quality_.bursts && due_us % kBurstEveryUs < kBurstUs) {
      due_us += kBurstUs - due_us % kBurstEveryUs;
    }
    last_us_ = std::max(last_us_, due_us);
    waiting_.push_back({last_us_, {bytes.begin(), bytes.end()}});
  }

  /// Calls take(bytes) for each message that has arrived by now.
  template <typename Take>
  void receive(std::uint64_t now_us, Take take) {
    while (!waiting_.empty() && waiting_.front().due_us <= now_us) {
      take(std::span<const std::byte>(waiting_.front().bytes));
      waiting_.pop_front();
    }
  }

 private:
  static constexpr double kAgainUs = 10'000;
  static constexpr std::uint64_t kBurstEveryUs = 2'000'000;
  static constexpr std::uint64_t kBurstUs = 200'000;
  struct Waiting {
    std::uint64_t due_us;
    std::vector<std::byte> bytes;
  };

  LineQuality quality_;
  std::mt19937 random_;
  std::uint64_t last_us_ = 0;
  std::deque<Waiting> waiting_;
};

}  // namespace kerf::agent
