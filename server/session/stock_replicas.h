// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>

#include "kernel/sculpture.h"
#include "server/convert/rejection.h"
#include "server/session/participants.h"

namespace kerf {

/// The replicas of the block that agents keep. Executor only.
class StockReplicas {
 public:
  /// Both must outlive this object.
  StockReplicas(Sculpture& sculpture, Participants& participants)
      : sculpture_(sculpture), participants_(participants) {}

  /// Returns the update that the participant's replica lacks; nullopt if it is complete or the
  /// participant keeps none.
  std::optional<StockUpdate> update(ParticipantId id);
  /// The participant has applied all patches up to `sequence`. Fails for a patch that was not sent,
  /// and for participants without a replica.
  std::expected<void, Rejection> ack(ParticipantId id, std::uint64_t sequence);
  /// The participant's replica is invalid: the next patch starts a new one. No effect for
  /// participants without a replica.
  void reset(ParticipantId id);
  /// Ends all updates.
  void close() { closed_ = true; }

 private:
  ParticipantState* owner(ParticipantId id);

  Sculpture& sculpture_;
  Participants& participants_;
  bool closed_ = false;
};

}  // namespace kerf
