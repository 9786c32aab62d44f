// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/files/journal_block.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "server/store/journal_origin.h"

namespace kerf::page {
namespace {

using Done = std::expected<void, std::string>;

/// Records that are sooner carved than their tiles are found in the history.
constexpr std::size_t kNear = 1000;
/// Records of a row of the page's own: reading from one decodes all rows since one that restarts.
constexpr std::size_t kRowRecords = BatchEncoder::kRecordsPerRestart;
constexpr auto kNoBudget = std::chrono::hours{1};

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
  block.origin_.assign(origin.begin(), origin.end());
  block.scene_ = std::make_shared<const Scene>(*std::move(scene));
  return block;
}

Done JournalBlock::make() {
  auto past = std::make_unique<LogPast>(scene_, log_);
  past_ = past.get();
  auto block = PastBlock::create(std::move(past));
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

void JournalBlock::append(std::span<const BatchRecord> records, std::int64_t wall_ms) {
  while (!records.empty()) {
    const std::size_t count = std::min(records.size(), kRowRecords);
    log_->append(records.first(count), wall_ms, 0);
    records = records.subspan(count);
  }
}

Done JournalBlock::check_hand() const {
  if (!hand_) return std::unexpected("no hand carves this block");
  if (block_->record() != log_->last()) {
    return std::unexpected("the block is at record " + std::to_string(block_->record()) + " of " +
                           std::to_string(log_->last()) + ": only its last state is carved");
  }
  return {};
}

Done JournalBlock::carve_by_hand(std::span<const wire::MotionSample> samples, std::int64_t wall_ms,
                                 std::int64_t span_ms) {
  if (auto ok = check_hand(); !ok) return ok;
  std::vector<BatchRecord> records;
  Done done;
  for (const wire::MotionSample& sample : samples) {
    auto record = hand_->take(sample, block_->block());
    if (!record) {
      done = std::unexpected(record.error());
    } else if (*record) {
      records.push_back(**std::move(record));
    }
  }
  log_->append(records, wall_ms, span_ms);
  if (auto carved = carve(records.size(), true); !carved) return carved;
  return done;
}

Done JournalBlock::change_by_hand(bool undone, std::int64_t wall_ms) {
  if (auto ok = check_hand(); !ok) return ok;
  const auto strokes = past_->strokes();
  if (!strokes) return std::unexpected(strokes.error());
  const ParticipantId author = hand_->participant();
  const StrokeId stroke = undone ? (*strokes)->newest(author, log_->last())
                                 : (*strokes)->last_undone(author, log_->last());
  if (stroke == 0) {
    return std::unexpected(undone ? "there is no stroke to undo" : "there is no stroke to redo");
  }
  const BatchRecord change{author, StrokeChange{stroke, undone}, false};
  log_->append({&change, 1}, wall_ms, 0);
  hand_->end_stroke();
  return carve(1, true);
}

std::expected<ToolId, std::string> JournalBlock::make_tool(std::string_view json,
                                                           std::int64_t wall_ms) {
  if (auto ok = check_hand(); !ok) return std::unexpected(ok.error());
  auto tool = parse_scene_tool(json, scene_->settings.tolerance_mm);
  if (!tool) return std::unexpected(to_string(tool.error()));
  const auto equal = std::ranges::find_if(
      scene_->tools, [&](const auto& one) { return one.second.tool == tool->tool; });
  if (equal != scene_->tools.end()) return equal->first;
  ToolId id = scene_->tools.rbegin()->first + 1;
  while (id == 0 || scene_->tools.contains(id)) ++id;
  const BatchRecord define{0, DefineTool{id, tool->tool}, false};
  log_->append({&define, 1}, wall_ms, 0);
  if (auto carved = carve(1, true); !carved) return std::unexpected(carved.error());
  Scene grown = *scene_;
  grown.tools.emplace(id, *std::move(tool));
  scene_ = std::make_shared<const Scene>(std::move(grown));
  past_->take_scene(scene_);
  made_.push_back({id, log_->last(), wall_ms});
  return id;
}

std::vector<std::byte> JournalBlock::rows() const { return log_->rows(); }

SolidSnapshot JournalBlock::solid() {
  mark(block_->take_changed());
  return block_->solid();
}

}  // namespace kerf::page
