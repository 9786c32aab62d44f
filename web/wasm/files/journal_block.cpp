// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/files/journal_block.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "kernel/cut/workers.h"
#include "server/history/block_history.h"
#include "server/store/journal_origin.h"

namespace kerf::page {
namespace {

using Done = std::expected<void, std::string>;

/// What the history of a page keeps: half of what a server does.
constexpr HistoryMemory kMemory{.windows = 64, .tile_bytes = std::size_t{128} << 20U};
/// Records that are sooner carved than their tiles are found in the history.
constexpr std::size_t kNear = 1000;
constexpr auto kNoBudget = std::chrono::hours{1};

/// The past of a journal in memory.
class LogPast final : public PastSource {
 public:
  LogPast(std::shared_ptr<const Scene> scene, std::shared_ptr<const RecordLog> log)
      : scene_(std::move(scene)), log_(std::move(log)) {}

  const Scene& scene() const override { return *scene_; }

  std::expected<std::optional<std::vector<TileReplacement>>, std::string> tiles_at(
      std::uint64_t record, const std::stop_token& stop) override {
    if (record > log_->last()) return std::nullopt;
    if (auto read = read_history(stop); !read) return std::unexpected(read.error());
    SerialWorkers alone;
    return history_->carve(history_->tiles(), history_->strokes().at(record), alone, stop);
  }

  std::expected<std::optional<std::vector<TileReplacement>>, std::string> tiles_after(
      const SolidSnapshot& solid, const StrokeSet& changed, std::uint64_t record,
      const std::stop_token& stop) override {
    if (auto read = read_history(stop); !read) return std::unexpected(read.error());
    SerialWorkers alone;
    return history_->change(solid, changed, history_->strokes().at(record), alone, stop);
  }

  std::expected<std::int64_t, std::string> time_of(std::uint64_t record) override {
    return log_->time_of(record);
  }

  std::expected<std::vector<JournalRecord>, std::string> records_after(
      std::uint64_t record, std::size_t count, const std::stop_token& /*stop*/) override {
    std::vector<JournalRecord> records;
    const RecordRange next{record + 1, record + count};
    const auto add = [&](JournalRecord& each) { records.push_back(std::move(each)); };
    if (auto read = log_->read({&next, 1}, add); !read) return std::unexpected(read.error());
    return records;
  }

 private:
  Done read_history(const std::stop_token& stop) {
    if (!history_) {
      auto untouched = Sculpture::create(scene_->settings);
      if (!untouched) return std::unexpected(untouched.error().reason);
      history_.emplace(log_records(log_), scene_->settings, untouched->solid(), kMemory);
    }
    return history_->catch_up(stop);
  }

  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const RecordLog> log_;
  std::optional<BlockHistory> history_;  ///< made when it is needed
};

}  // namespace

std::expected<JournalBlock, std::string> JournalBlock::read(std::span<const std::byte> origin) {
  auto given = read_origin(origin);
  if (!given) return std::unexpected(given.error());
  SceneSource source;
  source.name = given->session;
  source.files = std::move(given->files);
  source.load_mesh = load_mesh;
  auto scene = parse_scene(given->scene_json, source);
  if (!scene) return std::unexpected(to_string(scene.error()));
  JournalBlock block;
  block.scene_ = std::make_shared<const Scene>(*std::move(scene));
  return block;
}

Done JournalBlock::make() {
  auto block = PastBlock::create(std::make_unique<LogPast>(scene_, log_));
  if (!block) return std::unexpected(block.error());
  block_.emplace(*std::move(block));
  grid_ = block_->solid().fields.front().grid();
  mark_all(*grid_);
  return {};
}

Done JournalBlock::carve(std::size_t records, bool feels) {
  const std::uint64_t until = std::min<std::uint64_t>(log_->last(), block_->record() + records);
  const auto played = block_->play({.record = until, .feels = feels}, kNoBudget, {});
  if (!played) return std::unexpected(played.error());
  return {};
}

double JournalBlock::time_s(std::uint64_t record) const {
  if (record == 0) return 0;
  return static_cast<double>(log_->time_of(record) - log_->time_of(1)) * 1e-3;
}

std::optional<double> JournalBlock::next_s() const {
  if (block_->record() == log_->last()) return std::nullopt;
  return time_s(block_->record() + 1);
}

Done JournalBlock::seek(std::size_t record) {
  const std::uint64_t to = std::min<std::uint64_t>(record, log_->last());
  const std::uint64_t at = block_->record();
  if (to >= at && to - at <= kNear) return {};
  const auto found = block_->seek(to, {});
  if (!found) return std::unexpected(found.error());
  return {};
}

SolidSnapshot JournalBlock::solid() {
  mark(block_->take_changed());
  return block_->solid();
}

}  // namespace kerf::page
