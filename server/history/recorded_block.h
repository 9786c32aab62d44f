// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>

#include "kernel/sculpture.h"
#include "server/history/block_history.h"

namespace kerf {

/// A block to which the records of its journal are applied in order, without forces. Undo and redo
/// are applied when the solid is requested, which reads the journal a second time.
class RecordedBlock {
 public:
  /// `sculpture` has the records up to any one. `start` is its solid before the first.
  RecordedBlock(Sculpture sculpture, SolidSnapshot start, std::filesystem::path journal);

  /// Applies the next record. The error is one sentence.
  std::expected<void, std::string> apply(const JournalRecord& record);
  /// Makes the solid that of the motions that are not undone after the last record.
  std::expected<void, std::string> settle(const std::stop_token& stop = {});
  /// Its solid is valid after settle().
  Sculpture& sculpture() { return sculpture_; }
  const SolidSnapshot& start() const { return start_; }
  /// Whether settle() has work to do.
  bool has_changes() const { return !changed_.empty(); }

 private:
  Sculpture sculpture_;
  SolidSnapshot start_;
  std::filesystem::path journal_;
  std::unique_ptr<BlockHistory> history_;  ///< created on demand
  StrokeSet changed_;                      ///< undone or redone since the last settle()
  std::uint64_t last_ = 0;                 ///< record
};

/// Returns the strokes of a journal that are undone after its record `last`. A caller that also
/// reads the records passes the last one it read, because another may be committed in between.
std::expected<StrokeSet, std::string> undone_strokes(const std::filesystem::path& journal,
                                                     std::uint64_t last,
                                                     const std::stop_token& stop = {});

}  // namespace kerf
