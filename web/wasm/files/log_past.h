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
#include <utility>
#include <vector>

#include "server/formats/scene.h"
#include "server/history/block_history.h"
#include "server/session/past_block.h"
#include "web/wasm/files/record_log.h"

namespace kerf::page {

/// The past of a journal in memory, which others may extend.
class LogPast final : public PastSource {
 public:
  LogPast(std::shared_ptr<const Scene> scene, std::shared_ptr<const RecordLog> log);

  std::shared_ptr<const Scene> scene() const override { return scene_; }
  /// The scene has got a tool.
  void take_scene(std::shared_ptr<const Scene> scene) { scene_ = std::move(scene); }
  std::map<ToolId, Tool> tools() override;
  std::expected<std::optional<std::vector<TileReplacement>>, std::string> tiles_at(
      std::uint64_t record, const std::stop_token& stop) override;
  std::expected<std::optional<std::vector<TileReplacement>>, std::string> tiles_after(
      const SolidSnapshot& solid, const StrokeSet& changed, std::uint64_t record,
      const std::stop_token& stop) override;
  std::expected<std::int64_t, std::string> time_of(std::uint64_t record) override;
  std::expected<std::vector<JournalRecord>, std::string> records_after(
      std::uint64_t record, std::size_t count, const std::stop_token& stop) override;

  /// The strokes of all records, as of the last one. The error is one sentence.
  std::expected<const StrokeTable*, std::string> strokes();

 private:
  std::expected<void, std::string> read_history(const std::stop_token& stop);

  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const RecordLog> log_;
  std::optional<BlockHistory> history_;  ///< made when it is needed
};

}  // namespace kerf::page
