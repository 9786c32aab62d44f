// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <string>
#include <vector>

#include "server/store/journal_reader.h"
#include "server/store/record_batch.h"

namespace kerf {

/// Writes a journal made from the readable parts of a damaged one, in one transaction. Without
/// finish() no file remains.
class SalvageWriter {
 public:
  /// `header` must have its files (journal_base.h) and its epoch. `file` must not exist.
  static std::expected<SalvageWriter, JournalError> create(const std::filesystem::path& file,
                                                           const JournalHeader& header);
  SalvageWriter(SalvageWriter&& other) noexcept;
  SalvageWriter(const SalvageWriter&) = delete;
  ~SalvageWriter();

  /// Appends the next record, with its time.
  std::expected<void, JournalError> append(const JournalRecord& record, bool begins_stroke);
  /// Copies all rows other than records that belong to records up to `last`: hashes and versions
  /// only from record `first` on, hashes only before `hashes_end`. Returns a sentence for each
  /// unreadable part.
  std::expected<std::vector<std::string>, JournalError> copy_rest(const std::filesystem::path& from,
                                                                  const JournalReader& journal,
                                                                  std::uint64_t first,
                                                                  std::uint64_t last,
                                                                  std::uint64_t hashes_end);
  /// Commits to a temporary file and returns its path.
  std::expected<std::filesystem::path, JournalError> commit();
  /// Gives the committed file its name.
  std::expected<void, JournalError> finish();

 private:
  SalvageWriter(std::filesystem::path file, std::filesystem::path unfinished, SqlDatabase database)
      : file_(std::move(file)),
        unfinished_(std::move(unfinished)),
        database_(std::move(database)) {}
  std::expected<void, JournalError> write_batch();
  std::unexpected<JournalError> failed(const SqlError& error) const;

  std::filesystem::path file_, unfinished_;  ///< the latter is empty once finished
  std::optional<SqlDatabase> database_;
  BatchEncoder encoder_;
  BatchHead head_;
  std::vector<BatchRecord> records_;  ///< of the batch being collected
};

}  // namespace kerf
