// SPDX-License-Identifier: Apache-2.0
#include "server/session/resumable.h"

#include <utility>

namespace kerf {

Resumable::Resumable(std::span<const JournalParticipant> participants) {
  for (const JournalParticipant& participant : participants) {
    if (!participant.token) continue;
    keep(participant.participant,
         {*participant.token, participant.name, participant.color, participant.agent_sequence,
          DurableMark(participant.agent_sequence), participant.agent_sequence > 0});
  }
}

void Resumable::keep(ParticipantId id, ResumableAgent agent) {
  agents_.insert_or_assign(id, std::move(agent));
  if (agents_.size() > kKept) agents_.erase(agents_.begin());
}

ResumableAgent* Resumable::find(ParticipantId id) {
  const auto found = agents_.find(id);
  return found == agents_.end() ? nullptr : &found->second;
}

std::optional<ParticipantId> Resumable::owner(std::string_view token) const {
  const auto hash = hash_token(token);
  if (!hash) return std::nullopt;
  std::optional<ParticipantId> owner;
  for (const auto& [id, agent] : agents_) {
    if (are_equal(agent.token, *hash)) owner = id;
  }
  return owner;
}

}  // namespace kerf
