// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "server/store/record_batch.h"

namespace kerf {

/// A row of the table `batches`; `bytes` are the caller's.
struct BatchRow {
  BatchHead head;
  std::int64_t crc = 0;
  std::span<const std::byte> bytes = {};
};

/// Why a row was rejected, in a sentence, and the first record that is bad.
struct BadBatch {
  std::uint64_t sequence = 0;
  std::string reason;
};

/// Verifies a row, which must begin after record `last`, without decoding it.
std::expected<void, BadBatch> verify_row(const BatchRow& row, std::uint64_t last);

/// Verifies the rows of `batches`, one after the other, and decodes their records. Knows nothing of
/// where they are stored.
class BatchRows {
 public:
  /// Returns the records of a row, which must begin after record `last`. The first row must be one
  /// that can be decoded without those before; a record of a stroke that began before it has
  /// stroke 0.
  std::expected<std::vector<JournalRecord>, BadBatch> read(const BatchRow& row, std::uint64_t last);

 private:
  BatchDecoder decoder_;
  std::map<ParticipantId, std::uint64_t> strokes_;  ///< that each participant has begun last
};

}  // namespace kerf
