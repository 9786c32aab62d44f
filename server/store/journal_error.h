// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kerf {

enum class JournalErrorCode {
  kNotFound,        ///< the file does not exist
  kExists,          ///< the file of a new journal exists already
  kNotAJournal,     ///< not an SQLite file, or one of another program
  kForeignVersion,  ///< unsupported version of the tables
  kCorrupt,         ///< `sequence` is the first bad record (0: outside the records)
  kIo,              ///< an operation of the disk or the operating system failed
  kFull,            ///< the disk does not keep up and the bounded buffer is full
  kSessionLimit,    ///< the session's files have reached their limit
  kDiskLimit,       ///< the files of all sessions have reached their limit
  kLease,           ///< another server may own the session: this one's lease has expired
  kNotCopied,       ///< the records are committed, but their copy is not acknowledged yet
  kNotLoaded        ///< the session cannot be loaded for another reason, e.g. lack of memory
};

struct JournalError {
  JournalErrorCode code = JournalErrorCode::kIo;
  std::string file;
  std::uint64_t sequence = 0;
  std::string reason;  ///< one sentence
};

/// Whether a journal is paused by a limit rather than a failing disk: accepted records are then
/// committed.
constexpr bool is_limit(JournalErrorCode code) {
  return code == JournalErrorCode::kSessionLimit || code == JournalErrorCode::kDiskLimit;
}

/// Returns the cause of a pause in one word: "lease" or "disk".
constexpr const char* pause_word(JournalErrorCode code) {
  return code == JournalErrorCode::kLease ? "lease" : "disk";
}

/// Returns the name of a code in logs and in the HTTP interface, e.g. "corrupt_journal".
const char* to_string(JournalErrorCode code);
/// Returns "FILE: record N: reason".
std::string describe(const JournalError& error);

}  // namespace kerf
