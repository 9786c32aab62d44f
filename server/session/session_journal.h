// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "server/convert/rejection.h"
#include "server/session/copy_state.h"
#include "server/session/journal_health.h"
#include "server/session/participant.h"
#include "server/store/journal_writer.h"

namespace kerf {

/// Maximum time that a request waits for the copy of its change.
inline constexpr std::chrono::seconds kCopyPatience{3};

/// The journal of a session that another server runs: a copy that the cluster code extends.
struct FollowedJournal {
  std::filesystem::path file;
  std::uint32_t epoch = 1;                  ///< of the copy when it was opened
  std::atomic<std::uint64_t> sequence = 0;  ///< last record applied
};

/// The journal of a running session, and the newest state hash of its solid.
class SessionJournal {
 public:
  /// Continues a journal whose records have been replayed up to `replayed.sequence`.
  SessionJournal(JournalWriter writer, StateHash replayed);
  /// The journal of a session that follows another server's. It rejects commands and ignores other
  /// appends: nothing is written.
  SessionJournal(std::unique_ptr<FollowedJournal> followed, StateHash replayed);

  // ---- any thread ----
  const std::filesystem::path& file() const { return writer_ ? writer_->file() : followed_->file; }
  std::uint32_t epoch() const { return writer_ ? writer_->epoch() : followed_->epoch; }
  bool is_followed() const { return followed_ != nullptr; }
  /// Number of the last record appended, or applied if followed.
  std::uint64_t sequence() const {
    return writer_ ? writer_->last_sequence() : followed_->sequence.load();
  }
  /// Number of the last command that is committed.
  std::uint64_t committed() const { return writer_ ? writer_->durable_sequence() : sequence(); }
  /// Number of the last command that survives the loss of this machine if require_copy() was
  /// called: committed and copied. Otherwise that of the last committed command.
  std::uint64_t durable_sequence() const {
    return needs_copy_ ? std::min(committed(), copy_->record()) : committed();
  }
  /// Whether the session's lease has run out.
  bool is_fenced() const { return !writer_ || writer_->is_fenced(); }
  /// Call once, before the session is used.
  void require_copy() { needs_copy_ = true; }
  /// Number of records appended but not committed.
  std::size_t lag() const { return writer_ ? writer_->lag() : 0; }
  /// See JournalWriter.
  std::optional<JournalError> pause() const { return writer_ ? writer_->pause() : std::nullopt; }
  void hold(std::optional<JournalError> error) {
    if (writer_) writer_->hold(std::move(error));
  }
  /// Stores or removes an attachment. No effect in a followed journal.
  void attach(AttachmentChange change) {
    if (writer_) writer_->append(std::move(change));
  }
  /// State of the journal's copy on another machine.
  CopyNote& copy() const { return *copy_; }
  JournalFigures figures() const { return writer_ ? writer_->figures() : JournalFigures{}; }
  /// Blocks until all records appended before the call are committed.
  std::expected<void, JournalError> flush() {
    return writer_ ? writer_->flush() : std::expected<void, JournalError>();
  }
  /// Blocks until everything appended before the call is committed and, after require_copy(),
  /// copied: it then survives the loss of this machine. Fails with kNotCopied if the copy is not
  /// acknowledged within kCopyPatience.
  std::expected<void, JournalError> flush_and_copy();
  /// Returns kNotCopied, with the reason why the copy is behind.
  JournalError not_copied() const;
  /// The known damage of the file.
  JournalHealth& health() const { return *health_; }
  /// Commits and closes the file; later appends fail. Call once.
  std::expected<void, JournalError> finish() {
    health_->end();
    return writer_ ? writer_->finish() : std::expected<void, JournalError>();
  }

  // ---- executor only ----
  /// Appends a command and stores `note` with it. Fails with kBusy if the disk fails ("paused:
  /// disk: …") or does not keep up, and without a lease ("paused: lease: …").
  std::expected<void, Rejection> append(ParticipantId participant, const RecordedCommand& command,
                                        RecordNote note = {});
  /// Appends changes of strokes atomically.
  std::expected<void, Rejection> append(ParticipantId participant,
                                        std::span<const RecordedCommand> changes);
  /// Appends a participant, with the hash of its token if it may resume.
  void append(const Participant& participant, const std::optional<TokenHash>& token);
  /// Makes a participant unable to resume, even after a restart.
  void append_removal(const Participant& participant);
  void append(ListChange change) {
    if (writer_) writer_->append(std::move(change));
  }
  /// Fails with kBusy while the journal is paused or too many records are pending for programs. The
  /// rest of the buffer is for agents, which cannot wait.
  std::expected<void, Rejection> check_space_for_programs() const;

  /// Followed journal: record `sequence` is applied next.
  void advance(std::uint64_t sequence) { followed_->sequence = sequence; }

  /// The last command appended removed volume: hashes of earlier records are stale.
  void note_removal() { removal_sequence_ = sequence(); }
  /// Number of the last record that removed volume.
  std::uint64_t removal_sequence() const { return removal_sequence_; }
  /// The newest hash known, possibly of an earlier solid.
  const std::optional<StateHash>& newest_hash() const { return hash_; }
  /// The hash of the solid at sequence(), if known.
  std::optional<StateHash> current_hash() const;
  /// Stores and appends a hash; no effect if a newer one is known.
  void note_hash(StateHash state);

 private:
  std::optional<JournalWriter> writer_;        ///< set if this server runs the session
  std::unique_ptr<FollowedJournal> followed_;  ///< set if it follows the session
  std::uint64_t removal_sequence_;
  std::optional<StateHash> hash_;
  bool needs_copy_ = false;
  std::unique_ptr<CopyNote> copy_ = std::make_unique<CopyNote>();
  std::unique_ptr<JournalHealth> health_ = std::make_unique<JournalHealth>();
};

}  // namespace kerf
