// SPDX-License-Identifier: Apache-2.0
// The part of Session that updates the replicas of agents.
#include "server/session/session.h"

namespace kerf {

ParticipantState* Session::replica_owner(ParticipantId id) {
  ParticipantState* state = participants_.find(id);
  return state != nullptr && state->stock ? state : nullptr;
}

std::optional<StockUpdate> Session::stock_update(ParticipantId id) {
  ParticipantState* state = replica_owner(id);
  if (state == nullptr || closed_ || !state->track.pose()) return std::nullopt;
  const Tool* tool = sculpture_.tool(state->track.tool());
  return state->stock->next(sculpture_, {*tool, *state->track.pose(), state->newest_us});
}

std::expected<void, Rejection> Session::ack_stock(ParticipantId id, std::uint64_t sequence) {
  using enum wire::ErrorCode;
  ParticipantState* state = replica_owner(id);
  if (state == nullptr) {
    return std::unexpected(
        Rejection{kBadMessage, "ack without stock frames: hello must request \"stock\""});
  }
  if (state->stock->ack(sequence)) return {};
  return std::unexpected(
      Rejection{kBadSequence, "stock frame " + std::to_string(sequence) + " was not sent"});
}

wire::Intents Session::intents(ParticipantId id) {
  const ParticipantState* state = participants_.find(id);
  return state == nullptr || closed_ ? wire::Intents{} : participants_.near(*state);
}

void Session::reset_stock(ParticipantId id) {
  if (ParticipantState* state = replica_owner(id)) state->stock->reset();
}

}  // namespace kerf
