// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace kerf {

/// The limits of one session. A peer that exceeds one gets a typed rejection.
struct SessionLimits {
  std::size_t agents_max = 32;
  std::size_t viewers_max = 2000;
  std::size_t programs_max = 16;  ///< running at the same time
  /// Average rate of one agent: 1 kHz plus a margin for fast clocks.
  double samples_per_s = 1250;
  /// Burst of one agent. An agent that follows the protocol (wire/README, "limits") sends 900 at
  /// once. Samples sent before a pause of the network, at most 0.42 s, may arrive with them: 900 +
  /// 515.
  double samples_burst = 1500;
  double speed_mm_per_s = 5000;  ///< of the tip while cutting
  /// Joins of all agents and programs together, and of all viewers. Admits an audience that arrives
  /// at the same time, but not a peer that joins and leaves repeatedly.
  double carver_joins_per_s = 10, carver_joins_burst = 100;
  /// Joins with one invitation and its passes. If agents_max people use the same link, all may
  /// join, restart their agents together, and then each once in 30 s.
  double invitation_joins_per_s = 1, invitation_joins_burst = 64;
  double viewer_joins_per_s = 250, viewer_joins_burst = 1000;
  /// How long a viewer waits for its turn before it is rejected: long enough for viewers_max to
  /// join.
  double viewer_wait_max_s = 4;
  /// Guests of an open server (server/rights): fewer at a time, at a lower rate, and with a slower
  /// tool.
  std::size_t guest_agents_max = 8;
  double guest_joins_per_s = 0.5, guest_joins_burst = 8;
  double network_joins_per_s = 0.1, network_joins_burst = 4;  ///< of the guests of one network
  double guest_speed_mm_per_s = 500;
  std::int64_t tiles_max = 1 << 20;  ///< of the block: viewers receive every tile
};

}  // namespace kerf
