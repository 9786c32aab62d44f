// SPDX-License-Identifier: Apache-2.0
#include "server/session/resumable.h"

#include <algorithm>
#include <cstring>
#include <ranges>
#include <tuple>
#include <utility>

#include "server/store/journal_people.h"

namespace kerf {
namespace {

/// Returns the agent's state in the journal, as after a restart.
ResumableAgent stored(const JournalParticipant& participant) {
  return {*participant.token, participant.name, participant.color, participant.agent_sequence,
          DurableMark(participant.agent_sequence)};
}

}  // namespace

std::size_t Resumable::FirstBytes::operator()(const TokenHash& hash) const {
  std::size_t bytes = 0;
  std::memcpy(&bytes, hash.data(), sizeof bytes);
  return bytes;
}

Resumable::Resumable(std::span<const JournalParticipant> participants) {
  const auto has_token = [](const JournalParticipant& one) { return one.token.has_value(); };
  auto left_to_journal =
      std::ranges::count_if(participants, has_token) - static_cast<std::ptrdiff_t>(kKept);
  for (const JournalParticipant& one : participants | std::views::filter(has_token)) {
    tokens_[*one.token] = {one.participant, 0};
    if (left_to_journal-- > 0) continue;
    ResumableAgent agent = stored(one);
    agent.turn = ++turns_;
    agents_.emplace(one.participant, std::move(agent));
  }
}

void Resumable::keep(ParticipantId id, ResumableAgent agent,
                     const std::function<bool(ParticipantId)>& is_present, std::uint64_t record) {
  if (const ResumableAgent* known = find(id)) agent.resumes = known->resumes;
  agent.turn = ++turns_;
  tokens_[agent.token] = {id, 0};
  agents_.insert_or_assign(id, std::move(agent));
  if (agents_.size() > kKept) leave_one_to_journal(id, is_present, record);
}

void Resumable::leave_one_to_journal(ParticipantId except,
                                     const std::function<bool(ParticipantId)>& is_present,
                                     std::uint64_t record) {
  const auto order = [](const ResumableAgent& agent) {
    return std::tuple(agent.is_muted || agent.is_in_stock, agent.turn);
  };
  auto chosen = agents_.end();
  for (auto at = agents_.begin(); at != agents_.end(); ++at) {
    if (at->first == except || is_present(at->first)) continue;
    if (chosen == agents_.end() || order(at->second) < order(chosen->second)) chosen = at;
  }
  if (chosen == agents_.end()) return;
  tokens_[chosen->second.token].record = record;
  agents_.erase(chosen);
}

void Resumable::forget(ParticipantId id) {
  agents_.erase(id);
  std::erase_if(tokens_, [&](const auto& entry) { return entry.second.participant == id; });
}

ResumableAgent* Resumable::find(ParticipantId id) {
  const auto found = agents_.find(id);
  return found == agents_.end() ? nullptr : &found->second;
}

std::optional<ParticipantId> Resumable::owner(std::string_view token) const {
  const auto hash = hash_token(token);
  const auto found = hash ? tokens_.find(*hash) : tokens_.end();
  return found == tokens_.end() ? std::nullopt : std::optional(found->second.participant);
}

Resumable::Recall Resumable::recall(std::string_view token, const SessionJournal& journal,
                                    const std::function<bool(ParticipantId)>& is_present) {
  const auto hash = hash_token(token);
  const auto given = hash ? tokens_.find(*hash) : tokens_.end();
  if (given == tokens_.end()) return Recall::kDamaged;
  const auto [id, record] = given->second;
  if (find(id) != nullptr) return Recall::kFound;
  if (journal.committed() < record) return Recall::kLater;
  const auto agent = agent_of(journal.file(), id);
  const bool is_damaged = agent ? *agent && (*agent)->token != given->first
                                : agent.error().code == JournalErrorCode::kCorrupt;
  if (is_damaged) {
    forget(id);
    return Recall::kDamaged;
  }
  // The row of an agent is written with the group in which it joined.
  if (!agent || !*agent) return Recall::kLater;
  keep(id, stored(**agent), is_present, journal.sequence());
  return Recall::kFound;
}

}  // namespace kerf
