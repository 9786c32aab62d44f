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

/// Longest time from an append to the start of its group's commit.
inline constexpr std::chrono::milliseconds kGroupCommit{10};
/// Records that may be pending: four seconds of a stalled disk with 16 agents at 1 kHz.
inline constexpr std::size_t kJournalBufferRecords = kBatchRecordsMax;
/// A group whose commit failed is committed again at this interval.
inline constexpr std::chrono::milliseconds kJournalRetry{1000};

/// What a journal has done since it was opened.
struct JournalFigures {
  std::uint64_t commits = 0, failed_commits = 0;
  double commit_s = 0;          ///< duration of all commits, the failed ones included
  double oldest_pending_s = 0;  ///< age of the oldest record that is not committed
};

/// Writes a session's journal; one writer per file. append() copies into a bounded buffer, and a
/// flusher thread commits groups. Call append() from one thread at a time (the session's executor),
/// the other functions from any thread.
///
/// After a failed commit (the disk is full, an I/O error) the journal is paused: append() accepts
/// no command, and nothing else is written until that same group has been committed. The flusher
/// tries again every kJournalRetry; accepted records stay in memory. It is paused too while it is
/// held, or its fence is closed: then what was accepted is committed.
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

  /// Accepts commands only while `fence` is open, from now on. Call before the first append().
  void keep_within(std::shared_ptr<const WriteFence> fence);

  /// Appends a command and returns its sequence. Fails with kFull if the buffer is full, and with
  /// the error of the commit while the journal is paused, so that a session never runs ahead of a
  /// failed disk. `note` is stored with the command.
  std::expected<std::uint64_t, JournalError> append(ParticipantId participant,
                                                    const RecordedCommand& command,
                                                    RecordNote note = {});
  /// As append(), for commands that stand together: one transaction commits all of them, or none.
  std::expected<std::uint64_t, JournalError> append_together(
      ParticipantId participant, std::span<const RecordedCommand> commands);
  /// Stores or replaces a participant. Its token is stored when it comes for the first time.
  void append(const JournalParticipant& participant);
  /// Appends the hash of the solid after record `state.sequence`.
  void append(StateHash state);
  /// Changes a row of a list that people keep with the block.
  void append(ListChange change);
  /// Stores or removes an attachment. Any thread.
  void append(AttachmentChange change);
  /// Appends the hash of a block that this kernel has carved from the records of another one, and
  /// the version of this kernel, in one transaction.
  void append_recarved(StateHash state);

  /// Blocks until all records appended before the call are committed, or until a commit fails,
  /// whose error it returns. A paused journal is tried at once.
  std::expected<void, JournalError> flush();
  /// Commits the pending records and closes the file, which may then be moved or deleted. Later
  /// appends fail. After a failed commit it tries once more; an error means that records are lost.
  std::expected<void, JournalError> finish();
  std::uint64_t last_sequence() const;
  /// Sequence of the last command that is committed. Waits for nothing.
  std::uint64_t durable_sequence() const;
  /// Grows each time the journal is opened; peers use it to detect a restarted server.
  std::uint32_t epoch() const;
  /// Whether the fence is closed. Waits for nothing.
  bool is_fenced() const;
  /// Number of records appended and not yet committed.
  std::size_t lag() const;
  /// The error of the failed commit, of hold() or of the fence, while the journal is paused;
  /// nullopt otherwise.
  std::optional<JournalError> pause() const;
  /// Accepts no command from now on, because of `error`; nullopt ends that.
  void hold(std::optional<JournalError> error);
  JournalFigures figures() const;
  /// Calls `report` when a pause begins, with its error, and when it ends, with nullopt; on the
  /// flusher's thread or that of hold(), which must not call this writer. Not for the fence, which
  /// closes by itself. Replaces the previous function.
  void on_pause(std::function<void(const std::optional<JournalError>&)> report);
  const std::filesystem::path& file() const;

 private:
  struct Impl;
  explicit JournalWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
