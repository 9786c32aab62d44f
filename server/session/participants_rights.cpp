// SPDX-License-Identifier: Apache-2.0
// The part of Participants that applies roles and the decisions of owners.
#include <algorithm>
#include <ranges>
#include <utility>

#include "server/rights/rights.h"
#include "server/session/participants.h"

namespace kerf {

std::optional<Rejection> Participants::check_role(const JoinRequest& request,
                                                  ParticipantId resumed) const {
  const bool watches = request.kind == ParticipantKind::kViewer;
  const bool runs = request.kind == ParticipantKind::kProgram;
  const Action action = watches ? Action::kWatch : runs ? Action::kRunPrograms : Action::kCarve;
  const std::string role(to_string(request.role));
  if (!may(request.role, action)) {
    return Rejection{wire::ErrorCode::kNotAllowed,
                     role + "s may not join as " + to_string(request.kind) + "s"};
  }
  if (runs && request.is_muted) return muted_rejection();
  if (request.role != Role::kGuest || watches) return std::nullopt;
  const auto guests =
      std::ranges::count_if(states_ | std::views::values, [&](const ParticipantState& state) {
        const Participant& other = state.participant;
        return other.kind == ParticipantKind::kAgent && other.role == Role::kGuest &&
               other.id != resumed;
      });
  if (static_cast<std::size_t>(guests) < limits_.guest_agents_max) return std::nullopt;
  return Rejection{wire::ErrorCode::kBusy, "the session admits at most " +
                                               std::to_string(limits_.guest_agents_max) +
                                               " guests who carve; try again later"};
}

bool Participants::remove(ParticipantId id, const std::string& reason) {
  ParticipantState* state = find(id);
  if (state == nullptr || state->participant.kind == ParticipantKind::kProgram) return false;
  state->token.reset();
  resumable_.forget(id);
  if (state->participant.kind == ParticipantKind::kAgent) {
    journal_.append_removal(state->participant);
  }
  notify({.closing = reason, .removed = id});
  return true;
}

void Participants::remove_holders(std::span<const std::string> grants, const std::string& reason) {
  for (const std::string& grant : grants) decided_[grant].has_ended = true;
  std::vector<ParticipantId> holders;
  for (const auto& [id, state] : states_) {
    if (std::ranges::find(grants, state.grant) != grants.end()) holders.push_back(id);
  }
  for (const ParticipantId id : holders) remove(id, reason);
}

bool Participants::change_person(ParticipantId id,
                                 const std::function<void(ParticipantState&)>& change) {
  ParticipantState* state = find(id);
  if (state == nullptr) return false;
  const std::string person = state->person;
  change(*state);
  for (auto& [other, one] : states_) {
    if (other != id && !person.empty() && one.person == person) change(one);
  }
  changed(true);
  return true;
}

bool Participants::set_role(ParticipantId id, Role role) {
  return change_person(id, [&](ParticipantState& state) {
    state.participant.role = role;
    state.speed_mm_per_s =
        role == Role::kGuest ? limits_.guest_speed_mm_per_s : limits_.speed_mm_per_s;
  });
}

ParticipantId Participants::holder_of(const std::string& person) const {
  const auto is_holder = [&](const auto& entry) { return entry.second.person == person; };
  const auto found = std::ranges::find_if(states_, is_holder);
  return found == states_.end() ? 0 : found->first;
}

void Participants::set_role_of(const std::string& person, Role role) {
  if (person.empty()) return;
  decided_[person].role = role;
  set_role(holder_of(person), role);
}

void Participants::set_muted_of(const std::string& person, bool muted) {
  if (person.empty()) return;
  decided_[person].is_muted = muted;
  set_muted(holder_of(person), muted);
}

/// The grant of a request was checked at the upgrade of its connection, which may be seconds ago.
std::expected<JoinRequest, Rejection> Participants::as_decided(JoinRequest request) const {
  const auto found = decided_.find(request.grant);
  if (request.grant.empty() || found == decided_.end()) return request;
  const Decision& decision = found->second;
  if (decision.has_ended) {
    return std::unexpected(Rejection{wire::ErrorCode::kNotAllowed,
                                     "your invitation was revoked, or you were removed"});
  }
  request.role = decision.role.value_or(request.role);
  request.is_muted = decision.is_muted.value_or(request.is_muted);
  return request;
}

bool Participants::set_muted(ParticipantId id, bool muted) {
  return change_person(id, [&](ParticipantState& state) {
    state.participant.is_muted = muted;
    if (state.token) keep_resumable(state);
  });
}

}  // namespace kerf
