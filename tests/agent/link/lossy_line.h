// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>

namespace kerf::agent {

/// Faults of a line, the same in both directions. TCP is only delayed: a relay of bytes cannot lose
/// TCP segments (tests/bench/lossy_path.h can).
struct LineFaults {
  std::chrono::microseconds delay{0};
  /// Additional delay of TCP.
  std::chrono::microseconds tcp_delay{0};
  /// Shares of the datagrams, 0 to 1. A reordered one is delayed by 5 ms.
  double loss = 0, duplication = 0, reordering = 0;
  /// `burst` consecutive datagrams out of `burst_every` are lost. 0 disables this.
  int burst_every = 0, burst = 0;
  std::uint64_t seed = 1;
};

struct LineCounts {
  std::uint64_t datagrams = 0, lost = 0, duplicated = 0, reordered = 0;
};

/// Relay to a server on 127.0.0.1. It listens for TCP and UDP on 127.0.0.2 at the server's own port
/// numbers, so that the ports in the server's messages are valid here too.
class LossyLine {
 public:
  LossyLine(std::uint16_t tcp_port, std::uint16_t udp_port, LineFaults faults);
  ~LossyLine();

  static constexpr const char* kHost = "127.0.0.2";

  /// Blocks or unblocks all datagrams.
  void block_udp(bool blocked);
  /// Changes the source ports of the agents' datagrams, like a NAT that has lost its state.
  void rebind();
  LineCounts counts() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf::agent
