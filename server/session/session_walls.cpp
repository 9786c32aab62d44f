// SPDX-License-Identifier: Apache-2.0
#include "server/session/session_walls.h"

#include <ostream>

#include "server/history/recorded_block.h"
#include "server/session/replay.h"
#include "server/verify/wall_check.h"

namespace kerf {
namespace {

// Reads the motions of a journal. The line of each is the number of its record.
std::expected<Program, std::string> read_motions(JournalReader& reader, const StrokeSet& undone,
                                                 const std::stop_token& stop) {
  Program program;
  program.files = {"journal"};
  for (;;) {
    if (stop.stop_requested()) return std::unexpected("stopped");
    const auto record = reader.next();
    if (!record) return std::unexpected(describe(record.error()));
    if (!*record) return program;
    const auto* move = std::get_if<MoveTool>(&(*record)->command);
    if (move == nullptr || undone.contains((*record)->stroke)) continue;
    if (program.motions.size() == kWallMotionsMax)
      return std::unexpected("the journal has more than " + std::to_string(kWallMotionsMax) +
                             " motions, too many to be searched for thin walls; export the "
                             "program with tolerance_mm and use kerf-carve");
    ProgramMotion& motion = program.motions.emplace_back();
    motion.tool = move->tool;
    motion.from = move->from;
    motion.to = move->to;
    motion.duration_s = move->duration_s;
    motion.line = static_cast<std::uint32_t>((*record)->sequence);
  }
}

}  // namespace

ExportResult export_thin_walls(const std::filesystem::path& journal, const DexelSnapshot& field,
                               std::ostream& out, const std::stop_token& stop) {
  auto reader = JournalReader::open(journal);
  if (!reader) return std::unexpected(describe(reader.error()));
  const auto undone = undone_strokes(journal, reader->last_sequence(), stop);
  if (!undone) return std::unexpected(undone.error());
  auto scene = journal_scene(*reader, journal);
  if (!scene) return std::unexpected(describe(scene.error()));
  const auto program = read_motions(*reader, *undone, stop);
  if (!program) return std::unexpected(program.error());
  const WallCheck check(*scene, *program, wall_samples(*scene, *program), stop);
  WallReport report = check.find(stop);
  mark_missing(report.walls, field);
  if (scene->accuracy) report.target = check.target_at_walls(stop);
  if (stop.stop_requested()) return std::unexpected("stopped");
  out << check.json(report) << '\n';
  if (!out) return std::unexpected("cannot write the output");
  return {};
}

}  // namespace kerf
