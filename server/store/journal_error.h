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
  kSessionLimit,    ///< its files have the size that a session may have
  kDiskLimit,       ///< the files of all sessions have the size that they may have
  kLease,           ///< another server may have it: the lease of this one has run out
  kNotLoaded        ///< its session cannot be loaded for another reason, e.g. lack of memory
};

struct JournalError {
  JournalErrorCode code = JournalErrorCode::kIo;
  std::string file;
  std::uint64_t sequence = 0;
  std::string reason;  ///< one sentence
};

/// Whether a journal is paused by a limit, and not because its disk fails: what it has accepted is
/// committed.
constexpr bool is_limit(JournalErrorCode code) {
  return code == JournalErrorCode::kSessionLimit || code == JournalErrorCode::kDiskLimit;
}

/// Why a paused journal accepts nothing, in one word: "lease" or "disk".
constexpr const char* pause_word(JournalErrorCode code) {
  return code == JournalErrorCode::kLease ? "lease" : "disk";
}

/// Returns the name of a code in logs and in the HTTP interface, e.g. "corrupt_journal".
const char* to_string(JournalErrorCode code);
/// Returns "FILE: record N: reason".
std::string describe(const JournalError& error);

}  // namespace kerf
