// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>

namespace kerf::agent {

/// What a line does to what goes over it, in both directions alike. TCP is delayed only: a relay of
/// bytes cannot lose what TCP sends (tests/bench/lossy_path.h can).
struct LineFaults {
  std::chrono::microseconds delay{0};
  /// TCP takes this much longer.
  std::chrono::microseconds tcp_delay{0};
  /// Shares of the datagrams, 0 to 1; a reordered one is overtaken by those of the next 5 ms.
  double loss = 0, duplication = 0, reordering = 0;
  /// Each so many datagrams, so many are lost in a row; 0: none.
  int burst_every = 0, burst = 0;
  std::uint64_t seed = 1;
};

struct LineCounts {
  std::uint64_t datagrams = 0, lost = 0, duplicated = 0, reordered = 0;
};

/// A line to a server on 127.0.0.1: takes TCP and UDP on 127.0.0.2, at the server's own two port
/// numbers, so that what the server says of its ports leads here too.
class LossyLine {
 public:
  LossyLine(std::uint16_t tcp_port, std::uint16_t udp_port, LineFaults faults);
  ~LossyLine();

  static constexpr const char* kHost = "127.0.0.2";

  /// From now on no datagram passes, or all do again as the faults let them.
  void block_udp(bool blocked);
  /// The server sees the agents' datagrams come from other ports, as behind a NAT that forgot them.
  void rebind();
  LineCounts counts() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf::agent
