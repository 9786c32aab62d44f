// SPDX-License-Identifier: Apache-2.0
#include "server/session/journal_carve.h"

#include <utility>

#include "server/history/recorded_block.h"
#include "server/session/replay.h"

namespace kerf {

std::expected<CarvedJournal, std::string> carve_without(const std::filesystem::path& journal,
                                                        const StrokeSet& without) {
  auto reader = JournalReader::open(journal);
  if (!reader) return std::unexpected(describe(reader.error()));
  auto left_out = undone_strokes(journal, reader->last_sequence());
  if (!left_out) return std::unexpected(left_out.error());
  left_out->insert(without.begin(), without.end());
  const auto scene = journal_scene(*reader, journal);
  if (!scene) return std::unexpected(describe(scene.error()));
  auto first = first_block(*reader, *scene, journal);
  if (!first) return std::unexpected(describe(first.error()));
  Sculpture& block = first->sculpture;
  StrokeSet missing = without;
  for (;;) {
    const auto record = reader->next();
    if (!record) return std::unexpected(describe(record.error()));
    if (!*record) break;
    missing.erase((*record)->stroke);
    auto command = kernel_command((*record)->command);
    if (!command || left_out->contains((*record)->stroke)) continue;
    if (auto* move = std::get_if<MoveTool>(&*command)) move->feel = false;
    if (auto applied = block.apply(*command); !applied) {
      return std::unexpected("record " + std::to_string((*record)->sequence) + ": " +
                             applied.error().reason);
    }
  }
  if (!missing.empty()) {
    return std::unexpected("no stroke begins with record " + std::to_string(*missing.begin()));
  }
  return CarvedJournal{block.motions(), block.state_hash(), block.removed_volume_mm3()};
}

}  // namespace kerf
