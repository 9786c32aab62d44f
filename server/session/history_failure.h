// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <string>

#include "server/session/session.h"

namespace kerf {

/// The damage of a session's journal because of which a question about its history has failed, for
/// `reason`. Nullopt: it failed because others ask, the disk fails or `stop` was requested, so it
/// can be asked again. Blocks, as it may read the journal: not on the session's executor.
inline std::optional<JournalError> damage_after(const Session& session, const std::string& reason,
                                                const std::stop_token& stop) {
  if (reason == kOthersAskHistory || session.pause() || stop.stop_requested()) return std::nullopt;
  return session.health().find_damage(session.journal_file(), stop);
}

}  // namespace kerf
