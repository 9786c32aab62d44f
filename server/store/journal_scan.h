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

/// Verifies the scene and the checksums of all committed records of a journal, a part at a time,
/// beside its writer. Decodes no record. Between two parts no transaction is open, so that SQLite
/// can empty the write-ahead log.
class JournalScan {
 public:
  explicit JournalScan(std::filesystem::path journal) : file_(std::move(journal)) {}

  /// Verifies the next rows, until they have `bytes` bytes. Returns true after the last one. An
  /// error of code kCorrupt names the first bad record (0: outside the records); another one says
  /// why the journal cannot be read now, as after a stop, and the call can be repeated.
  std::expected<bool, JournalError> advance(std::size_t bytes, const std::stop_token& stop = {});
  /// Verifies the rest.
  std::expected<void, JournalError> finish(const std::stop_token& stop = {});
  /// The last record that was verified.
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

/// Verifies a journal from its beginning to its end; errors as of JournalScan.
std::expected<void, JournalError> scan_journal(const std::filesystem::path& journal,
                                               const std::stop_token& stop = {});

/// Says which record of a journal is damaged and what its operator can do, in one sentence without
/// the path of the file.
std::string damage_text(const JournalError& damage);

}  // namespace kerf
