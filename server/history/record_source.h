// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <limits>
#include <span>
#include <stop_token>
#include <string>

#include "server/store/journal_record.h"

namespace kerf {

/// A range of records, both ends included.
struct RecordRange {
  std::uint64_t first = 1;
  std::uint64_t last = std::numeric_limits<std::uint64_t>::max();
};

/// Source of the records of a history's journal. Not thread-safe.
class RecordSource {
 public:
  virtual ~RecordSource() = default;

  /// Calls `visit` with the existing records of some ascending ranges, all of one state of the
  /// journal. The stroke of a record may be 0 if it began before the range. The error is one
  /// sentence and names the first bad record.
  virtual std::expected<void, std::string> read(
      std::span<const RecordRange> ranges, const std::function<void(JournalRecord& record)>& visit,
      const std::stop_token& stop) = 0;
};

}  // namespace kerf
