// SPDX-License-Identifier: Apache-2.0
#include "server/http/session_lookup.h"

#include <utility>

#include "server/http/responses.h"

namespace kerf::net {

bool is_below_session(const std::vector<std::string>& path) {
  return path.size() > 2 && path[0] == "v1" && path[1] == "sessions";
}

bool is_coming(const SessionRegistry& registry, const std::string& id, bool only_looks) {
  if (registry.is_loading(id)) return true;
  if (registry.places() == nullptr) return false;
  if (registry.places()->is_moving(id)) return true;
  return only_looks && !registry.find(id) && registry.places()->wants_to_follow(id) &&
         !registry.find_followed(id);
}

std::shared_ptr<Session> find_to_look(const SessionRegistry& registry, const std::string& id) {
  auto session = registry.find(id);
  if (session || registry.places() == nullptr) return session;
  // This request counts as interest, so that the session keeps being followed.
  return registry.places()->wants_to_follow(id) ? registry.find_followed(id) : nullptr;
}

std::optional<std::string> other_place(const SessionRegistry& registry, const std::string& id) {
  return registry.places() == nullptr ? std::nullopt : registry.places()->address_of(id);
}

std::optional<std::string> needed_server(const SessionRegistry& registry, const std::string& id) {
  return registry.places() == nullptr ? std::nullopt : registry.places()->needed_server(id);
}

ApiResponse at_other_server(const std::string& reason, std::string location) {
  ApiResponse response = error_response(307, "other_server", reason);
  response.headers.emplace_back("Location", std::move(location));
  return response;
}

ApiResponse no_session(const SessionRegistry& registry, const std::string& id,
                       const std::string& target) {
  if (is_coming(registry, id) || registry.find(id)) {  // found now: it has just been opened
    ApiResponse response = error_response(503, "session_loading",
                                          "session " + id + " is being loaded; try again later");
    response.headers.emplace_back("Retry-After", "1");
    return response;
  }
  if (const auto address = other_place(registry, id)) {
    return at_other_server("session " + id + " is at " + *address, *address + target);
  }
  if (const auto node = needed_server(registry, id)) {
    return error_response(503, "server_lost",
                          "server " + *node + " ran session " + id +
                              " and is lost, and no other server has the journal: start it again");
  }
  if (const auto error = registry.unreadable(id)) {
    // The server retries the load after a disk error; damage is permanent.
    const unsigned status = error->code == JournalErrorCode::kIo ? 503 : 500;
    return error_response(status, "unreadable_session",
                          "the journal cannot be read and stays as it is: " + error->reason);
  }
  if (registry.is_stopping()) {  // 404 would be final for an agent
    ApiResponse response =
        error_response(503, "stopping", "the server is shutting down; try again later");
    response.headers.emplace_back("Retry-After", "1");
    return response;
  }
  return error_response(404, "unknown_session", "there is no session " + id);
}

void tell_regions(Session& session, const Access& access) {
  // Read the regions on the executor: after two concurrent changes, the later one must win.
  session.executor().post(
      [self = session.shared_from_this(), &access] { self->reserve(access.regions(self->id())); });
}

}  // namespace kerf::net
