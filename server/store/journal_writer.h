// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>

#include "server/store/journal_error.h"
#include "server/store/journal_file.h"
#include "server/store/journal_reader.h"
#include "server/store/journal_record.h"

namespace kerf {

/// Appended records wait at most this long before their group is committed (plus the commit
/// itself).
inline constexpr std::chrono::milliseconds kGroupCommit{10};
/// Records that may wait for the disk; at 16 agents of 1 kHz this is four seconds of a disk that
/// stands still.
inline constexpr std::size_t kJournalBufferRecords = 65'536;

/// The one writer of a session's journal. append() only copies into a bounded buffer; a thread of
/// its own commits groups. Calls come from one thread at a time (the session's executor); lag() and
/// flush() from any.
class JournalWriter {
 public:
  static std::expected<JournalWriter, JournalError> create(const std::filesystem::path& file,
                                                           const JournalHeader& header);
  /// Continues a journal behind record `last_sequence`, which a JournalReader has verified.
  static std::expected<JournalWriter, JournalError> open(const std::filesystem::path& file,
                                                         std::uint64_t last_sequence);
  JournalWriter(JournalWriter&&) noexcept;
  JournalWriter& operator=(JournalWriter&&) noexcept;
  /// Commits what is still in the buffer.
  ~JournalWriter();

  /// Records a command and returns its sequence. kFull when the buffer is full; kIo and the like
  /// once a commit has failed: from then on nothing more is accepted, so that a session never runs
  /// ahead of a broken disk.
  std::expected<std::uint64_t, JournalError> append(ParticipantId participant,
                                                    const Command& command);
  /// Remembers a participant's name and so on.
  void append(const JournalPerson& person);
  /// Records the hash of the solid after the record `state.sequence`.
  void append(StateHash state);

  /// Blocks until everything appended before the call is committed, or tells why it cannot be.
  std::expected<void, JournalError> flush();
  /// flush(), then closes the file: it may be moved or deleted afterwards. append() is rejected
  /// from now on.
  std::expected<void, JournalError> finish();
  std::uint64_t last_sequence() const;
  /// Grows each time that a journal is opened: peers use it to notice that a server was restarted.
  std::uint32_t epoch() const;
  /// Records appended but not yet committed.
  std::size_t lag() const;
  const std::filesystem::path& file() const;

 private:
  struct Impl;
  explicit JournalWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
