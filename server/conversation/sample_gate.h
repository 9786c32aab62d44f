// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "server/wire/types.h"

namespace kerf::net {

/// What a batch of samples brings, where batches may be lost, come twice or in another order.
enum class Arrival : std::uint8_t { kNew, kRepeated, kGap };

/// Keeps motions whole on a lane that loses: a batch counts only if it goes on where the last
/// applied sample ended. Across a gap there is no telling where the tool has been, and the chord
/// would gouge the block.
class SampleGate {
 public:
  /// The number of the last sample that the session has taken, over whichever lane.
  void applied(std::uint64_t agent_sequence) noexcept { last_ = agent_sequence; }

  /// Before the first sample of a WebSocket has come over it, everything is a gap: only its order
  /// tells where an agent that has been here before starts anew.
  Arrival judge(const wire::MotionBatch& batch) const noexcept {
    if (batch.count == 0 || last_ == 0) return Arrival::kGap;
    const auto samples = batch.view();
    if (samples.front().agent_sequence > last_ + 1) return Arrival::kGap;
    return samples.back().agent_sequence > last_ ? Arrival::kNew : Arrival::kRepeated;
  }

 private:
  std::uint64_t last_ = 0;
};

}  // namespace kerf::net
