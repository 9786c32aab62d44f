// SPDX-License-Identifier: Apache-2.0
// The journal that goes on from a program.
#include <span>
#include <utility>

#include "server/session/session_id.h"
#include "server/store/journal_origin.h"
#include "web/wasm/files/program_block.h"

namespace kerf::page {
namespace {

constexpr ParticipantId kSession = 0, kProgram = 1;

/// Returns what a journal of a scene begins with. The scene names files of the module's folder.
std::expected<JournalOrigin, std::string> origin_of(const Scene& scene) {
  JournalOrigin origin{
      .session = id_from_name(scene.name), .scene_json = scene_json(scene), .files = {}};
  const auto read = parse_scene(
      origin.scene_json,
      {.name = scene.name, .base_folder = ".", .keep_files = true, .load_mesh = load_mesh});
  if (!read) return std::unexpected(to_string(read.error()));
  origin.files = read->files;
  return origin;
}

}  // namespace

std::expected<JournalBlock, std::string> ProgramBlock::as_journal(std::int64_t wall_ms) const {
  const auto origin = origin_of(scene_);
  if (!origin) return std::unexpected(origin.error());
  auto journal = JournalBlock::read(encode_origin(*origin));
  if (!journal) return journal;
  std::vector<BatchRecord> records;
  for (const auto& [id, tool] : scene_.tools) {
    records.push_back({kSession, DefineTool{id, tool.tool}, false});
  }
  for (const ProgramMotion& motion : std::span(program_.motions).first(carved_)) {
    const MoveTool move{motion.tool, motion.from, motion.to, motion.duration_s, false};
    records.push_back({kProgram, move, &motion == program_.motions.data()});
  }
  journal->append(records, wall_ms);
  return journal;
}

}  // namespace kerf::page
