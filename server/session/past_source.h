// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "server/formats/scene.h"
#include "server/history/stroke_table.h"

namespace kerf {

/// The data of a journal and its history that PastBlock needs. Errors are one sentence.
class PastSource {
 public:
  virtual ~PastSource() = default;

  /// The scene, with the tools that were made so far.
  virtual std::shared_ptr<const Scene> scene() const = 0;
  /// The tools that the records may use up to the last one asked for.
  virtual std::map<ToolId, Tool> tools() { return tools_of(*scene()); }
  /// Returns all tiles that motions reach, as of a record. Nullopt if there is no such record yet.
  virtual std::expected<std::optional<std::vector<TileReplacement>>, std::string> tiles_at(
      std::uint64_t record, const std::stop_token& stop) = 0;
  /// Returns the tiles changed by a record (or a run of records) that undoes or redoes strokes. It
  /// may return more tiles. `solid`: the block before them.
  virtual std::expected<std::optional<std::vector<TileReplacement>>, std::string> tiles_after(
      const SolidSnapshot& /*solid*/, const StrokeSet& /*changed*/, std::uint64_t record,
      const std::stop_token& stop) {
    return tiles_at(record, stop);
  }
  /// Returns when a record was appended, ms since 1970, UTC; 0 if unknown.
  virtual std::expected<std::int64_t, std::string> time_of(std::uint64_t record) = 0;
  /// Returns at most `count` records after `record`.
  virtual std::expected<std::vector<JournalRecord>, std::string> records_after(
      std::uint64_t record, std::size_t count, const std::stop_token& stop) = 0;
};

}  // namespace kerf
