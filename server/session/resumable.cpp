// SPDX-License-Identifier: Apache-2.0
#include "server/session/resumable.h"

#include <algorithm>
#include <utility>

namespace kerf {

Resumable::Resumable(std::span<const JournalParticipant> participants) {
  for (const JournalParticipant& participant : participants) {
    if (!participant.token) continue;
    keep(participant.participant,
         {*participant.token, participant.name, participant.color, participant.agent_sequence,
          DurableMark(participant.agent_sequence)},
         [](ParticipantId) { return false; });
  }
}

void Resumable::keep(ParticipantId id, ResumableAgent agent,
                     const std::function<bool(ParticipantId)>& is_present) {
  if (const ResumableAgent* known = find(id)) agent.resumes = known->resumes;
  agents_.insert_or_assign(id, std::move(agent));
  if (agents_.size() <= kKept) return;
  const auto oldest = std::ranges::find_if(
      agents_, [&](const auto& entry) { return entry.first != id && !is_present(entry.first); });
  if (oldest != agents_.end()) agents_.erase(oldest);
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
