// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

#include "kernel/sculpture.h"
#include "server/convert/rejection.h"
#include "server/platform/clock.h"
#include "server/session/carving.h"
#include "server/session/participants.h"
#include "server/session/session_journal.h"
#include "server/session/session_owner.h"
#include "server/session/session_past.h"
#include "server/session/stroke_request.h"
#include "server/threads/executor.h"

namespace kerf {

class Workers;

/// Undoes and redoes strokes of a session.
class StrokeChanges {
 public:
  /// The parts of the session that it works with.
  struct Parts {
    Executor& executor;  ///< of the session
    Sculpture& sculpture;
    SessionJournal& journal;
    SessionPast& past;
    Participants& participants;
    Carving& carving;
  };
  /// `parts` and `background`, which does work that nobody waits for, must outlive this. Calls
  /// `settled` on the executor when changes have been carved into the block.
  StrokeChanges(const Parts& parts, Executor& background, SessionOwner owner,
                std::function<void()> settled);

  // ---- any thread ----
  /// Undoes or redoes strokes. Afterwards the block is, to the bit, as if only the remaining
  /// strokes had happened. Blocks until then: do not call on the executor. Participants carve
  /// meanwhile: the session's thread is used for about a millisecond at a time. Requests wait for
  /// each other. Errors: kNotAllowed; kBadMessage for a stroke that does not exist or is already in
  /// that state; kBusy if the disk fails or `stop` was requested early; kDamagedJournal.
  std::expected<StrokesChanged, Rejection> change(const StrokeRequest& request, Workers& workers,
                                                  const std::stop_token& stop = {});

  // ---- executor only ----
  using Done = std::function<void(const std::expected<StrokesChanged, Rejection>&)>;
  /// Like change(), from the executor. The work is done on the background thread while the executor
  /// serves participants. `done` is called on the executor, once the change is durable
  /// (SessionJournal::durable_sequence). If it is not within kCopyPatience, `pending` says why.
  void change_later(StrokeRequest request, Done done);
  /// Followed session: its owner has journaled this change. It is carved later.
  void follow(const StrokeChange& change);
  /// Whether a change is not yet carved into the block.
  bool are_pending() const { return !unsettled_.empty(); }
  /// Does background work on this executor from now on; it must outlive this. Call once, when the
  /// session has been created.
  void work_on(Executor& background) { background_ = &background; }
  /// Ends all changes.
  void close() { closed_ = true; }

 private:
  using Outcome = std::expected<void, std::string>;
  bool may_change(const StrokeRequest& request, ParticipantId participant);
  std::optional<Rejection> note(const StrokeRequest& request, std::span<const Stroke> all);
  Outcome try_to_settle(Workers& workers, const std::stop_token& stop, StrokesChanged& changed);
  Outcome settle(Workers& workers, const std::stop_token& stop, StrokesChanged& changed);
  Outcome settle_tiles(std::span<const FieldTile> some, Workers& workers,
                       const std::stop_token& stop, StrokesChanged& changed);
  Outcome wait_for_pieces(const std::stop_token& stop);
  void answer_when_durable(StrokesChanged changed, Clock::time_point end, Done done);
  void retry_settling();
  void settle_later();

  Executor& executor_;
  Sculpture& sculpture_;
  SessionJournal& journal_;
  SessionPast& past_;
  Participants& participants_;
  Carving& carving_;
  Executor* background_;
  SessionOwner owner_;
  std::function<void()> settled_;
  bool closed_ = false;
  std::map<StrokeId, std::uint64_t> unsettled_;  ///< record of each change not yet carved
};

}  // namespace kerf
