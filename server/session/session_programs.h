// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "kernel/sculpture.h"
#include "server/platform/clock.h"
#include "server/rights/caller.h"
#include "server/session/carving.h"
#include "server/session/participants.h"
#include "server/session/program_runs.h"
#include "server/session/session_journal.h"
#include "server/session/session_owner.h"
#include "server/store/attachment.h"
#include "server/threads/executor.h"

namespace kerf {

/// The programs of a session: each is a participant that carves in slices between the motions of
/// agents. Executor only.
class SessionPrograms {
 public:
  /// Minimum interval between two reports of changed programs.
  static constexpr std::chrono::milliseconds kUpdateInterval{250};
  /// The parts of the session that it works with.
  struct Parts {
    Executor& executor;  ///< of the session
    const Sculpture& sculpture;
    SessionJournal& journal;
    Participants& participants;
    Carving& carving;
  };
  /// Calls into the session.
  struct Hooks {
    std::function<std::expected<Participant, Rejection>(const JoinRequest&)> join;
    std::function<void(ParticipantId)> leave;
    /// A slice has been carved; `removed`: it has removed material.
    std::function<void(bool removed)> carved;
  };
  /// `parts` must outlive this object.
  SessionPrograms(const Parts& parts, SessionOwner owner, Hooks hooks);

  /// Carves a program as a further participant, at once or after another one. Rejects tools that
  /// the scene lacks, and an `after` that is unknown or has ended without having finished.
  std::expected<ProgramStatus, Rejection> start(ProgramJob job, ProgramOptions request,
                                                const Caller& caller = Caller::local());
  /// Lists the programs that were running when another server ended, or this one at its last stop.
  void list_stopped(const std::vector<Attachment>& attachments);
  std::vector<ProgramStatus> list() const { return runs_.list(); }
  // See ProgramRuns.
  std::optional<ProgramStatus> status(ProgramId id) const { return runs_.status(id); }
  std::shared_ptr<const ProgramText> text(ProgramId id) const { return runs_.text(id); }
  std::vector<ProgramGlance> glances() const { return runs_.glances(); }
  void drop_ended_texts() { runs_.drop_ended_texts(0); }
  bool order(ProgramId id, ProgramOrder order);
  bool set_pace(ProgramId id, ProgramPace pace, double speed);
  bool cancel(ProgramId id);
  /// Returns the programs if they have changed since the last call and a report is due, or with
  /// `all` if there ever was one.
  std::optional<std::vector<ProgramGlance>> update(bool all);
  /// Cancels all programs. Their attachments stay for the next start.
  void close();

 private:
  std::expected<ProgramId, Rejection> predecessor(ProgramId after) const;
  void schedule();
  void run();
  void retire(bool for_good);

  Executor& executor_;
  const Sculpture& sculpture_;
  SessionJournal& journal_;
  Participants& participants_;
  Carving& carving_;
  SessionOwner owner_;
  Hooks hooks_;
  ProgramRuns runs_;
  bool is_scheduled_ = false;
  std::uint64_t sent_ = 0;  ///< ProgramRuns::changes() as of the last update
  Clock::time_point sent_at_{};
};

}  // namespace kerf
