// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "server/session/session_registry.h"

namespace kerf {

/// Logs that a session pauses because of an error, or continues (nullopt).
void log_pause(const std::string& id, const std::optional<JournalError>& error);
/// Logs that the journal of an open session is damaged, and the remedy.
void log_damage(const std::string& id, const JournalError& damage);
void log_snapshot_failure(const std::string& id, const std::string& reason);
/// Logs the outcome of loading sessions.
void log_report(const LoadReport& report);

}  // namespace kerf
