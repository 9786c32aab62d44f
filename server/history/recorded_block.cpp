// SPDX-License-Identifier: Apache-2.0
#include "server/history/recorded_block.h"

#include <algorithm>
#include <span>
#include <utility>

#include "server/history/journal_records.h"
#include "server/store/journal_reader.h"

namespace kerf {

RecordedBlock::RecordedBlock(Sculpture sculpture, SolidSnapshot start,
                             std::filesystem::path journal)
    : sculpture_(std::move(sculpture)), start_(std::move(start)), journal_(std::move(journal)) {}

std::expected<void, std::string> RecordedBlock::apply(const JournalRecord& record) {
  last_ = record.sequence;
  if (const auto* change = std::get_if<StrokeChange>(&record.command)) {
    changed_.insert(change->stroke);
    return {};
  }
  auto command = kernel_command(record.command);
  if (auto* move = std::get_if<MoveTool>(&*command)) move->feel = false;
  const auto applied = sculpture_.apply(*command);
  if (!applied) return std::unexpected(applied.error().reason);
  return {};
}

std::expected<void, std::string> RecordedBlock::settle(const std::stop_token& stop) {
  if (changed_.empty()) return {};
  if (!history_) {
    history_ =
        std::make_unique<BlockHistory>(journal_records(journal_), sculpture_.settings(), start_);
  }
  if (auto ok = history_->catch_up(stop); !ok) return ok;
  SerialWorkers alone;
  const MotionSet set = history_->strokes().at(last_);
  const auto reached = history_->reach(changed_, stop);
  if (!reached) return std::unexpected(reached.error());
  for (std::span<const FieldTile> left(*reached); !left.empty();) {
    const auto some = left.first(std::min(kTilesAtOnce, left.size()));
    left = left.subspan(some.size());
    const auto tiles = history_->change(sculpture_.solid(), some, changed_, set, alone, stop);
    if (!tiles) return std::unexpected(tiles.error());
    sculpture_.replace(*tiles);
  }
  changed_.clear();
  return {};
}

std::expected<StrokeSet, std::string> undone_strokes(const std::filesystem::path& journal,
                                                     std::uint64_t last,
                                                     const std::stop_token& stop) {
  auto reader = JournalReader::open(journal, RecordOrder::kSequence, stop);
  if (!reader) return std::unexpected(describe(reader.error()));
  StrokeSet undone;
  for (;;) {
    if (stop.stop_requested()) return std::unexpected("stopped");
    const auto record = reader->next();
    if (!record) return std::unexpected(describe(record.error()));
    if (!*record || (*record)->sequence > last) return undone;
    const auto* change = std::get_if<StrokeChange>(&(*record)->command);
    if (change == nullptr) continue;
    if (change->undone) {
      undone.insert(change->stroke);
    } else {
      undone.erase(change->stroke);
    }
  }
}

}  // namespace kerf
