// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "server/store/journal_error.h"
#include "server/store/journal_file.h"
#include "server/store/journal_group.h"
#include "server/store/journal_reader.h"
#include "server/store/journal_record.h"
#include "server/store/write_fence.h"

namespace kerf {

/// Maximum time from an append to the start of its group's commit.
inline constexpr std::chrono::milliseconds kGroupCommit{10};
/// Maximum number of pending records: four seconds of a stalled disk with 16 agents at 1 kHz.
inline constexpr std::size_t kJournalBufferRecords = kBatchRecordsMax;
/// Interval of the retries after a failed commit.
inline constexpr std::chrono::milliseconds kJournalRetry{1000};

/// Statistics of a journal since it was opened.
struct JournalFigures {
  std::uint64_t commits = 0, failed_commits = 0;
  double commit_s = 0;          ///< duration of all commits, including failed ones
  double oldest_pending_s = 0;  ///< age of the oldest uncommitted record
};

/// Writes a session's journal; one writer per file. append() copies into a bounded buffer, and a
/// flusher thread commits groups. Call append() from one thread at a time (the session's executor),
/// the other functions from any thread.
///
/// A failed commit (full disk, I/O error) pauses the journal: append() accepts no command, and
/// nothing else is written until that same group has been committed. The flusher retries every
/// kJournalRetry. Accepted records stay in memory. hold() and a closed fence also pause it;
/// accepted records are then still committed.
class JournalWriter {
 public:
  static std::expected<JournalWriter, JournalError> create(const std::filesystem::path& file,
                                                           const JournalHeader& header);
  /// Continues a journal after record `last_sequence`, the last one read by a JournalReader.
  static std::expected<JournalWriter, JournalError> open(const std::filesystem::path& file,
                                                         std::uint64_t last_sequence);
  JournalWriter(JournalWriter&&) noexcept;
  JournalWriter& operator=(JournalWriter&&) noexcept;
  /// Commits the pending records.
  ~JournalWriter();

  /// From now on, accepts commands only while `fence` is open. Call before the first append().
  void keep_within(std::shared_ptr<const WriteFence> fence);

  /// Appends a command with its `note` and returns its sequence. Fails with kFull if the buffer is
  /// full, and with the error of the pause while the journal is paused, so that a session never
  /// runs ahead of a failed disk.
  std::expected<std::uint64_t, JournalError> append(ParticipantId participant,
                                                    const RecordedCommand& command,
                                                    RecordNote note = {});
  /// Appends several commands atomically: one transaction commits all of them or none. Errors as
  /// for append().
  std::expected<std::uint64_t, JournalError> append_together(
      ParticipantId participant, std::span<const RecordedCommand> commands);
  /// Stores or replaces a participant. Only its first token is stored.
  void append(const JournalParticipant& participant);
  /// Appends the hash of the solid after record `state.sequence`.
  void append(StateHash state);
  /// Changes a row of a list that people keep with the block.
  void append(ListChange change);
  /// Stores or removes an attachment. Any thread.
  void append(AttachmentChange change);
  /// Appends the hash of a block that this kernel has carved from another version's records, and
  /// the version of this kernel, in one transaction.
  void append_recarved(StateHash state);

  /// Blocks until all records appended before the call are committed, or until a commit fails, and
  /// returns its error. A paused journal is retried at once.
  std::expected<void, JournalError> flush();
  /// Commits the pending records and closes the file, which may then be moved or deleted. Later
  /// appends fail. Retries once after a failed commit; an error means that records are lost.
  std::expected<void, JournalError> finish();
  std::uint64_t last_sequence() const;
  /// Sequence of the last committed command. Does not block.
  std::uint64_t durable_sequence() const;
  /// Increases each time the journal is opened, so that peers detect a restarted server.
  std::uint32_t epoch() const;
  /// Whether the fence is closed. Does not block.
  bool is_fenced() const;
  /// Number of records appended but not committed.
  std::size_t lag() const;
  /// The cause of the pause: the error of the failed commit, of hold() or of the fence. Nullopt if
  /// the journal is not paused.
  std::optional<JournalError> pause() const;
  /// Pauses the journal because of `error`; nullopt ends this.
  void hold(std::optional<JournalError> error);
  JournalFigures figures() const;
  /// Calls `report` with the error when a pause begins, and with nullopt when it ends, on the
  /// thread of the flusher or of hold(). `report` must not call this writer. The fence closes
  /// without a report. Replaces the previous function.
  void on_pause(std::function<void(const std::optional<JournalError>&)> report);
  const std::filesystem::path& file() const;

 private:
  struct Impl;
  explicit JournalWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
