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

/// Writes the journal that is made from the readable parts of a damaged one. All of it is one
/// transaction; without finish() no file stays.
class SalvageWriter {
 public:
  /// `header`: with its files (journal_base.h) and its epoch. `file` must not exist.
  static std::expected<SalvageWriter, JournalError> create(const std::filesystem::path& file,
                                                           const JournalHeader& header);
  SalvageWriter(SalvageWriter&& other) noexcept;
  SalvageWriter(const SalvageWriter&) = delete;
  ~SalvageWriter();

  /// Appends the next record, with its time.
  std::expected<void, JournalError> append(const JournalRecord& record, bool begins_stroke);
  /// Copies all that is no record and belongs to records up to `last`; hashes and versions only
  /// from record `first` on, hashes only before `hashes_end`. Returns a sentence for each part that
  /// cannot be read.
  std::expected<std::vector<std::string>, JournalError> copy_rest(const std::filesystem::path& from,
                                                                  const JournalReader& journal,
                                                                  std::uint64_t first,
                                                                  std::uint64_t last,
                                                                  std::uint64_t hashes_end);
  /// Commits all of it to a file of another name, and returns that.
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

  std::filesystem::path file_, unfinished_;  ///< the latter is empty at the end
  std::optional<SqlDatabase> database_;
  BatchEncoder encoder_;
  BatchHead head_;
  std::vector<BatchRecord> records_;  ///< of the batch that is being collected
};

}  // namespace kerf
