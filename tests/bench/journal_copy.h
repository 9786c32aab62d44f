// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "server/store/journal_reader.h"
#include "tests/bench/live_client.h"

namespace kerf::bench {

/// A copy of a journal and its log in their present state, e.g. after a kill. Reading the journal
/// itself would let SQLite repair it.
class JournalCopy {
 public:
  explicit JournalCopy(const std::filesystem::path& journal) : file_(journal.string() + ".copy") {
    remove_journal(file_);
    for (const char* suffix : {"", "-wal"}) {
      std::error_code absent;
      std::filesystem::copy_file(journal.string() + suffix, file_.string() + suffix, absent);
    }
  }
  ~JournalCopy() { remove_journal(file_); }
  JournalCopy(const JournalCopy&) = delete;
  JournalCopy& operator=(const JournalCopy&) = delete;

  const std::filesystem::path& file() const { return file_; }
  /// Returns the last sample of each agent that the journal has.
  std::map<ParticipantId, std::uint64_t> agent_sequences() const {
    const auto reader = JournalReader::open(file_);
    if (!reader) fail(describe(reader.error()));
    std::map<ParticipantId, std::uint64_t> found;
    for (const JournalParticipant& participant : reader->participants()) {
      found[participant.participant] = participant.agent_sequence;
    }
    return found;
  }

 private:
  std::filesystem::path file_;
};

}  // namespace kerf::bench
