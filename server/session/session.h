// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "server/formats/scene.h"
#include "server/platform/clock.h"
#include "server/rights/caller.h"
#include "server/session/carving.h"
#include "server/session/disk_limits.h"
#include "server/session/hash_keeper.h"
#include "server/session/live_state.h"
#include "server/session/participants.h"
#include "server/session/replay.h"
#include "server/session/session_info.h"
#include "server/session/session_journal.h"
#include "server/session/session_limits.h"
#include "server/session/session_matters.h"
#include "server/session/session_name.h"
#include "server/session/session_past.h"
#include "server/session/session_places.h"
#include "server/session/session_programs.h"
#include "server/session/session_tools.h"
#include "server/session/shared_scene.h"
#include "server/session/shown_figures.h"
#include "server/session/snapshot_keeper.h"
#include "server/session/snapshot_schedule.h"
#include "server/session/stock_replicas.h"
#include "server/session/stroke_changes.h"
#include "server/threads/executor.h"

namespace kerf {

class Workers;

/// Viewers of followed sessions have ids above this. The owner's participants have ids below.
inline constexpr ParticipantId kFollowerIds = 0x4000'0000;

/// One block with its participants, programs and journal. Functions under "executor only" must run
/// on the session's executor, which decides the order of motions.
class Session : public std::enable_shared_from_this<Session> {
 public:
  /// Minimum interval between two reports of changed participants.
  static constexpr std::chrono::milliseconds kChangeInterval{250};

  /// Takes over a replayed (or new) block and its journal. `workers` computes state hashes and must
  /// outlive the session.
  Session(std::string id, Replayed replayed, SessionJournal journal, SessionLimits limits,
          std::shared_ptr<Executor> executor, Executor& workers,
          std::span<const MakeMatter> matters);
  ~Session();

  // ---- any thread ----
  const std::string& id() const { return id_; }
  /// The scene as of now. It grows by the tools that are made, and has the session's current name:
  /// keep the pointer, not parts of it.
  std::shared_ptr<const Scene> scene() const { return scene_.get(); }
  std::uint32_t epoch() const { return journal_.epoch(); }
  /// The session from which this one was branched; empty id if none.
  const JournalParent& parent() const { return parent_; }
  const std::filesystem::path& journal_file() const { return journal_.file(); }
  Executor& executor() { return *executor_; }
  const DexelGrid& grid() const { return sculpture_.grid(); }
  /// Blocks until all motions applied before the call are in the journal file.
  std::expected<void, JournalError> flush() { return journal_.flush(); }
  /// SessionJournal::flush_and_copy.
  std::expected<void, JournalError> flush_and_copy() { return journal_.flush_and_copy(); }
  /// Commits and closes the journal. With `with_snapshot`, writes a last snapshot if that saves
  /// time at the next start. Call once, after close(). Afterwards no snapshot is written.
  std::expected<void, JournalError> finish_journal(bool with_snapshot = false) {
    return snapshots_.finish_journal(with_snapshot);
  }
  /// Number of the last record that is committed.
  std::uint64_t committed() const { return journal_.committed(); }
  std::size_t journal_lag() const { return journal_.lag(); }  ///< records not yet committed
  /// The error of the disk or the lease while the session is paused, else nullopt. Motions are then
  /// rejected (kBusy) until a write succeeds (retried every second), the disk limit allows more, or
  /// the lease is renewed.
  std::optional<JournalError> pause() const { return journal_.pause(); }
  JournalFigures journal_figures() const { return journal_.figures(); }
  CopyNote& copy() const { return journal_.copy(); }
  JournalHealth& health() const { return journal_.health(); }
  /// The history of the block.
  SessionPast& past() { return past_; }
  const SessionPast& past() const { return past_; }
  /// Undo and redo.
  StrokeChanges& stroke_changes() { return stroke_changes_; }
  /// Stores or removes an attachment of the journal. No effect in a followed session.
  void attach(AttachmentChange change) { journal_.attach(std::move(change)); }
  /// Size of the journal, its side files and the snapshots, bytes.
  std::uintmax_t disk_bytes() const { return session_bytes(journal_.file()); }
  /// Does not block, even while the executor is busy.
  SessionFigures figures() const { return figures_.get(); }
  /// Motions applied since the server started.
  std::uint64_t motions_applied() const { return carving_.motions_applied(); }
  /// CPU time of the session's thread by participant, s.
  std::map<ParticipantId, double> cpu_costs() const { return carving_.costs().all(); }

  /// Pauses the session while its files or the data folder have reached a limit. Writes no
  /// snapshots when they are close to it. `shared` is the level of the limits that all sessions
  /// share. Call from one thread at a time.
  void keep_disk_limits(const DiskLimits& limits, const DiskUse& use, DiskLevel shared);
  /// Sets the times of figures(), as read from the journal. Call once, before the session is used.
  void note_times(std::int64_t created_ms, std::int64_t active_ms) {
    figures_.set_times(created_ms, active_ms);
  }
  /// Carves motions of several participants in parallel from now on, on `carvers`, which must
  /// outlive the session. Call once, when the session has been created.
  void carve_on(Workers& carvers) { carvers_ = &carvers; }
  /// Sets the servers that may continue the session; they must outlive it. With `needs_copy`,
  /// samples and changes are durable only once they are copied. Call once, when the session has
  /// been created.
  void place_in(const SessionPlaces* places, bool needs_copy) {
    places_ = places;
    if (needs_copy) journal_.require_copy();
  }
  /// Addresses of the other servers that may continue the session.
  std::vector<std::string> other_servers() const {
    return places_ == nullptr ? std::vector<std::string>{} : places_->other_servers();
  }
  /// Writes snapshots periodically from now on. Call once, when the session has been created.
  void keep_snapshots(SnapshotOptions options);

  // ---- executor only ----
  std::expected<Admission, Rejection> admit(const JoinRequest& request);
  /// Like admit(), for a participant that does not resume.
  std::expected<Participant, Rejection> join(const JoinRequest& request);
  void leave(ParticipantId id);
  /// Who participates, and their rights.
  Participants& people() { return participants_; }
  /// Removes the holders of these grants and cancels their programs.
  void remove_holders(std::span<const std::string> grants, const std::string& reason);
  /// Replaces the reserved regions of the block.
  void reserve(const std::vector<Region>& regions) { carving_.reserve(regions); }
  /// Validates, journals and applies each sample in turn. A rejected sample changes nothing and
  /// does not stop the samples after it.
  MotionAnswer move(ParticipantId id, std::span<const wire::MotionSample> samples);
  /// Like move(), for one turn of the executor. Returns nullopt if the samples are more work than
  /// that, or wait to be carved in parallel with those of other moving agents. The caller then
  /// repeats go_on() in later turns until it returns the answer. Motions of other participants may
  /// come in between. The solid does not depend on that.
  std::optional<MotionAnswer> begin_move(ParticipantId id,
                                         std::span<const wire::MotionSample> samples);
  std::optional<MotionAnswer> go_on(ParticipantId id);
  /// The agent's newest durable sample (DurableMark); 0 if none.
  std::uint64_t durable_sequence(ParticipantId id);
  /// Whether another agent is moving, so that a participant with much work must leave it half of
  /// the time.
  bool has_other_agent(ParticipantId id) const {
    return participants_.has_active_agent(Participants::kAgentIsActive, id);
  }
  /// Whether a motion is partly cut, or an undo or redo is not yet carved into the solid, so that
  /// the solid matches no record of the journal.
  bool is_between_records() const {
    return carving_.is_between_records() || stroke_changes_.are_pending();
  }

  /// Returns the poses of other agents' tools near the participant's; empty unless it has requested
  /// them.
  wire::Intents intents(ParticipantId id);
  /// The replicas of the block that agents keep.
  StockReplicas& replicas() { return replicas_; }
  /// The programs, each of which carves as a participant.
  SessionPrograms& programs() { return programs_; }
  /// The tools, those that were made among them.
  SessionTools& tools() { return tools_; }
  /// The name, which people may change.
  SessionName& name() { return matters_.get<SessionName>(); }
  /// The lists that people keep with the block.
  SessionMatters& matters() { return matters_; }

  SessionInfo info() const;
  /// All participants. A followed session does not know its owner's viewers.
  std::vector<Participant> participants() const;
  /// The participants as viewers see them. Viewers at other servers are counted.
  Roster roster() const;
  SessionFrame frame(bool with_snapshot);
  SolidSnapshot solid() { return sculpture_.solid(); }
  std::uint64_t sequence() const { return journal_.sequence(); }
  /// The hash of the solid at sequence(), if known.
  std::optional<StateHash> current_hash() const { return journal_.current_hash(); }
  /// Stores and journals a hash that was computed while is_between_records() was false.
  void note_hash(StateHash state) { hashes_.note(state); }

  // For a followed session, which another server runs:
  /// Applies the next records of the journal's file for some milliseconds and returns how many.
  /// Undone and redone strokes are carved later. The error is one sentence.
  std::expected<std::size_t, std::string> follow(std::span<const JournalRecord> records);
  /// Compares the owner's hash with that of the solid. Returns false if the two cannot be compared,
  /// because they belong to different states. The error is one sentence that describes a mismatch.
  std::expected<bool, std::string> compare_hash(StateHash owners) const;
  void follow_live(LiveState state, std::size_t viewers_elsewhere);
  // For a session that other servers follow:
  LiveState live_state() const;  ///< without the viewers
  void note_viewers_elsewhere(std::size_t viewers);

  /// Calls `listener` on the executor at each event until unlisten() with the returned number.
  /// Changes of participants are collected and reported at most every kChangeInterval.
  int listen(SessionListener listener) { return participants_.listen(std::move(listener)); }
  void unlisten(int listener) { participants_.unlisten(listener); }
  /// Notifies the listeners and cancels the programs. Nothing is applied afterwards.
  void close(const std::string& reason, const std::string& redirect = {});
  bool closed() const { return closed_; }
  /// Whether another server runs the session.
  bool is_followed() const { return journal_.is_followed(); }

 private:
  void end_turn(bool removed);
  void forget_batch(ParticipantId id);
  void finish_left();
  MotionAnswer rejected_move() const;
  void report_changes();
  void show_figures();
  void show_live(SessionFrame& frame, bool all);

  std::shared_ptr<Executor> executor_;  ///< first, so that it is destroyed last
  std::string id_;
  Sculpture sculpture_;
  SessionLimits limits_;
  SessionJournal journal_;
  SessionPast past_;
  Participants participants_;
  Carving carving_;
  StrokeChanges stroke_changes_;
  SnapshotKeeper snapshots_;
  SessionPrograms programs_;
  HashKeeper hashes_;
  StockReplicas replicas_;
  ShownFigures figures_;
  const SessionPlaces* places_ = nullptr;  ///< null if there is only one server
  Workers* carvers_ = nullptr;             ///< null: the session's thread carves alone
  bool closed_ = false;
  DiskLevel own_disk_level_ = DiskLevel::kFine;  ///< this and the next: keep_disk_limits()
  std::optional<JournalErrorCode> reached_;      ///< the disk limit that has been reached
  Clock::time_point changes_reported_{};
  SharedScene scene_;
  SessionMatters matters_;
  SessionTools& tools_;  ///< one of the matters
  JournalParent parent_;
  std::optional<LiveState> live_;  ///< followed session: the newest statement of its owner
  std::string live_programs_sent_;
  std::size_t viewers_elsewhere_ = 0;
};

}  // namespace kerf
