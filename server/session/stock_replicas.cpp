// SPDX-License-Identifier: Apache-2.0
#include "server/session/stock_replicas.h"

namespace kerf {

ParticipantState* StockReplicas::owner(ParticipantId id) {
  ParticipantState* state = participants_.find(id);
  return state != nullptr && state->stock ? state : nullptr;
}

std::optional<StockUpdate> StockReplicas::update(ParticipantId id) {
  ParticipantState* state = owner(id);
  if (state == nullptr || closed_ || !state->track.pose()) return std::nullopt;
  const Tool* tool = sculpture_.tool(state->track.tool());
  return state->stock->next(sculpture_, {*tool, *state->track.pose(), state->newest_us});
}

std::expected<void, Rejection> StockReplicas::ack(ParticipantId id, std::uint64_t sequence) {
  using enum wire::ErrorCode;
  ParticipantState* state = owner(id);
  if (state == nullptr) {
    return std::unexpected(
        Rejection{kBadMessage, "ack without stock frames: hello must request \"stock\""});
  }
  if (state->stock->ack(sequence)) return {};
  return std::unexpected(
      Rejection{kBadSequence, "stock frame " + std::to_string(sequence) + " was not sent"});
}

void StockReplicas::reset(ParticipantId id) {
  if (ParticipantState* state = owner(id)) state->stock->reset();
}

}  // namespace kerf
