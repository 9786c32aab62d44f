// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kerf {

enum class JournalErrorCode {
  kNotFound,        ///< no such file
  kExists,          ///< a new session must not overwrite an old one
  kNotAJournal,     ///< not SQLite, or SQLite of another program
  kForeignVersion,  ///< written by a version of Kerf that this one cannot read
  kCorrupt,         ///< damaged: `sequence` is the first bad record (0: outside the records)
  kIo,              ///< the disk or the operating system rejected
  kFull             ///< the disk does not keep up: the bounded buffer is full
};

struct JournalError {
  JournalErrorCode code = JournalErrorCode::kIo;
  std::string file;
  std::uint64_t sequence = 0;
  std::string reason;  ///< one sentence
};

/// The name of a code as logs and the HTTP interface write it, e.g. "corrupt_journal".
const char* to_string(JournalErrorCode code);
/// "FILE: record N: reason".
std::string describe(const JournalError& error);

}  // namespace kerf
