// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "server/http/api_call.h"
#include "server/session/participant.h"

namespace kerf::net {

/// The participant and person that a request is about, as known now.
struct FoundParticipant {
  Participant participant;
  std::string person;
};

/// Finds a participant of a session by its number as text.
std::optional<FoundParticipant> find_participant(Session& session, const std::string& number);
/// Returns a 404: no participant of the session has this number.
ApiResponse no_participant(const std::string& number);

/// Handlers of people_routes.cpp.
ApiResponse change_participant(const ApiCall& call);
ApiResponse remove_participant(const ApiCall& call);
ApiResponse list_authors(const ApiCall& call);

}  // namespace kerf::net
