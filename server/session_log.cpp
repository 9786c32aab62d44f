// SPDX-License-Identifier: Apache-2.0
#include "server/session_log.h"

#include "server/log/log.h"

namespace kerf {

void log_pause(const std::string& id, const std::optional<JournalError>& error) {
  if (error && is_limit(error->code)) {
    log::error("session " + id + ": paused: disk: " + error->reason +
               "; motions are rejected until then");
  } else if (error) {
    log::error("session " + id + ": paused: disk: " + describe(*error) +
               "; motions are rejected and the commit is tried every " +
               std::to_string(kJournalRetry.count()) + " ms");
  } else {
    log::info("session " + id + ": the journal may be written again; the session continues");
  }
}

void log_damage(const std::string& id, const JournalError& damage) {
  log::error("session " + id + ": " + to_string(damage.code) + ": " + describe(damage) +
             "; it goes on, but undo and exports fail, and so does a start without its snapshot: "
             "close it, keep its files, and run 'kerf-server salvage FILE OUT'");
}

void log_snapshot_failure(const std::string& id, const std::string& reason) {
  log::warn("session " + id + ": no snapshot can be written: " + reason +
            "; the next start will take longer");
}

void log_report(const LoadReport& report) {
  for (const std::string& id : report.loaded) log::info("session " + id + " is loaded");
  for (const JournalError& failure : report.failures) {
    log::error(std::string(to_string(failure.code)) + ": " + describe(failure) +
               "; its session is not open, and its journal stays as it is");
  }
  for (const IgnoredSnapshot& snapshot : report.ignored) {
    log::warn("session " + snapshot.id + ": its snapshot was ignored: " + snapshot.reason +
              (snapshot.used_sequence == 0
                   ? "; all records were replayed"
                   : "; the one before it, after record " + std::to_string(snapshot.used_sequence) +
                         ", was used"));
  }
  for (const ShortenedSession& session : report.shortened) {
    log::warn("session " + session.id + ": the journal ends after record " +
              std::to_string(session.last_sequence) +
              ", before its newest state hash: what came later is lost, and the hash was dropped");
  }
  for (const RecarvedSession& session : report.recarved) {
    log::warn("session " + session.id + ": the journal is of kernel version " +
              std::to_string(session.kernel_version) + "; carved again with version " +
              std::to_string(kKernelVersion));
  }
}

}  // namespace kerf
