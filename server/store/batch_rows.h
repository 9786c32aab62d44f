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

/// A row of the table `batches`. The caller owns `bytes`.
struct BatchRow {
  BatchHead head;
  std::int64_t crc = 0;
  std::span<const std::byte> bytes = {};
};

/// Why a row was rejected, as one sentence, and its first bad record.
struct BadBatch {
  std::uint64_t sequence = 0;
  std::string reason;
};

/// Verifies a row, which must begin after record `last`. Does not decode it.
std::expected<void, BadBatch> verify_row(const BatchRow& row, std::uint64_t last);

/// Verifies successive rows of `batches` and decodes their records, independent of their storage.
class BatchRows {
 public:
  /// Returns the records of a row, which must begin after record `last`. The first row must be
  /// decodable without its predecessors. A record of a stroke that began before that row has stroke
  /// 0.
  std::expected<std::vector<JournalRecord>, BadBatch> read(const BatchRow& row, std::uint64_t last);

 private:
  BatchDecoder decoder_;
  std::map<ParticipantId, std::uint64_t> strokes_;  ///< the newest stroke of each participant
};

}  // namespace kerf
