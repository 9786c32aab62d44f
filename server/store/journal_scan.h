// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <stop_token>

#include "server/store/journal_error.h"
#include "server/store/sqlite.h"

namespace kerf {

/// Verifies the scene and the record checksums of a journal, a part at a time, in parallel with its
/// writer. Decodes no records. Between parts no transaction is open, so that SQLite can empty the
/// write-ahead log.
class JournalScan {
 public:
  explicit JournalScan(std::filesystem::path journal) : file_(std::move(journal)) {}

  /// Verifies the next rows, about `bytes` bytes. Returns true after the last one. The error
  /// kCorrupt names the first bad record, 0 if it is outside the records. After any other error,
  /// e.g. a stop, the journal cannot be read now and the call can be repeated.
  std::expected<bool, JournalError> advance(std::size_t bytes, const std::stop_token& stop = {});
  /// Verifies the rest.
  std::expected<void, JournalError> finish(const std::stop_token& stop = {});
  /// Number of the last verified record.
  std::uint64_t verified() const { return verified_; }

 private:
  std::expected<bool, JournalError> scan(SqlDatabase& database, std::size_t bytes);
  std::expected<bool, JournalError> scan_singles(SqlDatabase& database, std::size_t& bytes);
  std::expected<bool, JournalError> scan_batches(SqlDatabase& database, std::size_t& bytes);
  std::unexpected<JournalError> corrupt(std::uint64_t sequence, std::string reason) const;
  std::unexpected<JournalError> failed(const SqlError& error) const;

  std::filesystem::path file_;
  std::uint64_t verified_ = 0;
  bool has_head_ = false;  ///< the scene has been verified
};

/// Verifies a whole journal. Errors as for JournalScan.
std::expected<void, JournalError> scan_journal(const std::filesystem::path& journal,
                                               const std::stop_token& stop = {});

/// Names the damaged record and the operator's remedy in one sentence, without the path.
std::string damage_text(const JournalError& damage);

}  // namespace kerf
