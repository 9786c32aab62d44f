// SPDX-License-Identifier: Apache-2.0
// The part of SessionRegistry that names sessions, each differently.
#include <algorithm>

#include "server/session/session_registry.h"
#include "server/store/plain_text.h"
#include "server/threads/run_and_wait.h"

namespace kerf {

std::expected<void, Error> SessionRegistry::check_name_free(const std::string& name,
                                                            const std::string& except) const {
  if (!is_plain_text(name, kSessionNameBytesMax)) {
    return std::unexpected(Error{ErrorKind::kInvalid, "bad_name",
                                 "name must be 1 to " + std::to_string(kSessionNameBytesMax) +
                                     " bytes of UTF-8 without control characters"});
  }
  const auto has_it = [&](const auto& session) {
    return session->id() != except && session->scene()->name == name;
  };
  const auto has_it_elsewhere = [&](const PlacedSession& session) {
    return session.id != except && session.name == name;
  };
  if (std::ranges::any_of(list(), has_it) ||
      (options_.places != nullptr &&
       std::ranges::any_of(options_.places->elsewhere(), has_it_elsewhere))) {
    return std::unexpected(Error{ErrorKind::kConflict, "name_taken",
                                 "another session has this name: choose another one"});
  }
  return {};
}

std::expected<void, Error> SessionRegistry::rename(Session& session, const std::string& name) {
  const std::lock_guard lock(naming_);
  if (auto ok = check_name_free(name, session.id()); !ok) return ok;
  return run_and_wait(session.executor(), [&] { return session.name().set(name); });
}

}  // namespace kerf
