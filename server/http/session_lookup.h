// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/http/api_call.h"
#include "server/rights/access.h"
#include "server/session/session_registry.h"

namespace kerf::net {

/// Whether a path is that of a session or below it.
bool is_below_session(const std::vector<std::string>& path);
/// Returns a 307 to `location`, an absolute URL for the same request.
ApiResponse at_other_server(const std::string& reason, std::string location);
/// Returns the response for a session that is not open: a 307 to `target` at the server that runs
/// it, a 503 with Retry-After while it is being loaded or moved, a 503 `server_lost` if its server
/// is lost and nobody else has the journal, a 500 if its journal cannot be read, otherwise a 404.
ApiResponse no_session(const SessionRegistry& registry, const std::string& id,
                       const std::string& target);
/// Whether a session is not open yet but soon will be, here or at another server. With
/// `only_looks`, asks this server to follow another server's session, and also returns true until
/// it does.
bool is_coming(const SessionRegistry& registry, const std::string& id, bool only_looks = false);
/// Finds the session for a request that only looks at it: an own session, or one that this server
/// follows.
std::shared_ptr<Session> find_to_look(const SessionRegistry& registry, const std::string& id);
/// The address of the other server that runs a session; nullopt if there is none.
std::optional<std::string> other_place(const SessionRegistry& registry, const std::string& id);
/// The name of the lost server that alone can continue a session; nullopt if there is none.
std::optional<std::string> needed_server(const SessionRegistry& registry, const std::string& id);

/// Gives a session its reserved regions. Call before anybody can carve.
void tell_regions(Session& session, const Access& access);

}  // namespace kerf::net
