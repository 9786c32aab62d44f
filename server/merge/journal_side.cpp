// SPDX-License-Identifier: Apache-2.0
#include "server/merge/journal_side.h"

#include <algorithm>
#include <utility>

#include "server/session/replay.h"
#include "server/store/journal_base.h"

namespace kerf {
namespace {

void add(JournalSide& side, JournalRecord record) {
  const bool is_motion = std::holds_alternative<MoveTool>(record.command);
  side.owners.push_back({record.participant, is_motion ? record.stroke : 0});
  side.strokes.add(record);
  if (auto* tool = std::get_if<DefineTool>(&record.command)) {
    side.tools.insert_or_assign(tool->id, std::move(tool->tool));
  } else if (const auto* change = std::get_if<StrokeChange>(&record.command)) {
    RecordOrigin origin = side.origins.of(record.sequence);
    StrokeMark mark{origin.clock, std::move(origin.writer), origin.number, change->undone,
                    record.participant};
    StrokeMark& newest = side.marks[change->stroke];
    if (newest < mark) newest = std::move(mark);
  }
}

}  // namespace

std::expected<JournalSide, JournalError> read_side(const std::filesystem::path& file,
                                                   const std::stop_token& stop) {
  auto reader = JournalReader::open(file, RecordOrder::kSequence, stop);
  if (!reader) return std::unexpected(reader.error());
  if (const std::uint64_t base = base_record(reader->header().files); base > 0) {
    return std::unexpected(JournalError{
        JournalErrorCode::kCorrupt, file.string(), base,
        "the file is salvaged: the motions up to this record are lost, so nobody can tell which "
        "strokes it has; merge a backup instead"});
  }
  const auto damaged = reader->damaged_rows();
  if (!damaged) return std::unexpected(damaged.error());
  if (std::ranges::any_of(*damaged, [](const auto& rows) { return rows.table == kOriginsTable; })) {
    return std::unexpected(JournalError{
        JournalErrorCode::kCorrupt, file.string(), 0,
        "a row of the table origins is damaged, so nobody can tell which strokes both files have; "
        "merge a backup instead"});
  }
  const auto scene = journal_scene(*reader, file, stop);
  if (!scene) return std::unexpected(scene.error());
  JournalSide side{
      .header = reader->header(),
      .participants = reader->participants(),
      .lists = reader->lists(),
      .origins = RecordOrigins(reader->header().session, reader->parent(),
                               reader->lists().at(kOriginsTable), reader->last_sequence()),
      .tolerance_mm = scene->settings.tolerance_mm};
  for (;;) {
    auto record = reader->next();
    if (!record) return std::unexpected(record.error());
    if (!*record) return side;
    if (stop.stop_requested()) {
      return std::unexpected(JournalError{JournalErrorCode::kIo, file.string(), 0, "stopped"});
    }
    add(side, **std::move(record));
  }
}

}  // namespace kerf
