// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <string>

#include "server/session/session.h"

namespace kerf {

/// Returns the damage of a session's journal that made a question about its history fail with
/// `reason`. Nullopt if the failure is temporary (history in use, failing disk, `stop` requested):
/// retry. May read the journal and block: do not call on the session's executor.
inline std::optional<JournalError> damage_after(const Session& session, const std::string& reason,
                                                const std::stop_token& stop) {
  if (reason == kOthersAskHistory || session.pause() || stop.stop_requested()) return std::nullopt;
  return session.health().find_damage(session.journal_file(), stop);
}

}  // namespace kerf
