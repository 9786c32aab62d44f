// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "server/wire/types.h"

namespace kerf::net {

/// Classifies a batch of samples on a transport that may lose, repeat and reorder batches.
enum class Arrival : std::uint8_t { kNew, kRepeated, kGap };

/// Accepts a batch only if it continues at the last applied sample. Across a gap the path of the
/// tool is unknown, and its chord would gouge the block.
class SampleGate {
 public:
  /// Sets the number of the last sample that the session has applied, over either transport.
  void applied(std::uint64_t agent_sequence) noexcept { last_ = agent_sequence; }

  /// Returns kGap for every batch until a sample has come over the WebSocket: an agent that
  /// reconnects numbers its samples from 1, and only the WebSocket keeps their order.
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
