// SPDX-License-Identifier: Apache-2.0
#include "server/session/replay.h"

#include <algorithm>

#include "server/session/hash_text.h"

namespace kerf {
namespace {

JournalError corrupt(const std::filesystem::path& file, std::uint64_t sequence,
                     std::string reason) {
  return {JournalErrorCode::kCorrupt, file.string(), sequence, std::move(reason)};
}

/// Disables force computation, which does not affect the solid, to speed up the replay.
Command without_force(Command command) {
  if (auto* move = std::get_if<MoveTool>(&command)) move->feel = false;
  return command;
}

}  // namespace

std::expected<Scene, JournalError> journal_scene(const JournalReader& reader,
                                                 const std::filesystem::path& file) {
  SceneSource source;
  source.name = reader.header().session;
  if (!reader.header().base_folder.empty()) source.base_folder = reader.header().base_folder;
  source.files = reader.header().files;
  auto scene = parse_scene(reader.header().scene_json, source);
  if (!scene) {
    return std::unexpected(
        corrupt(file, 0, "the stored scene is invalid: " + to_string(scene.error())));
  }
  return *std::move(scene);
}

std::expected<Replayed, JournalError> replay(const std::filesystem::path& file) {
  auto reader = JournalReader::open(file);
  if (!reader) return std::unexpected(reader.error());
  auto scene = journal_scene(*reader, file);
  if (!scene) return std::unexpected(scene.error());
  auto sculpture = Sculpture::create(scene->settings);
  if (!sculpture) return std::unexpected(corrupt(file, 0, sculpture.error().reason));

  const auto& hashes = reader->state_hashes();
  const bool comparable = reader->header().kernel_version == kKernelVersion && !hashes.empty();
  const StateHash newest = comparable ? hashes.back() : StateHash{};  // sequence 0: no hash
  std::uint64_t last_sequence = 0;
  for (;;) {
    auto record = reader->next();
    if (!record) return std::unexpected(record.error());
    if (!*record) break;
    last_sequence = (*record)->sequence;
    const auto applied = sculpture->apply(without_force(std::move((*record)->command)));
    if (!applied) return std::unexpected(corrupt(file, last_sequence, applied.error().reason));
    if (newest.sequence == last_sequence && sculpture->state_hash() != newest.hash) {
      return std::unexpected(corrupt(file, last_sequence,
                                     "replay gives state hash " +
                                         hash_text(sculpture->state_hash()) +
                                         ", the journal stores " + hash_text(newest.hash)));
    }
  }
  ParticipantId last_participant = 0;
  for (const JournalParticipant& participant : reader->participants()) {
    last_participant = std::max(last_participant, participant.participant);
  }
  const StateHash hash{last_sequence, sculpture->state_hash()};
  return Replayed{*std::move(scene),
                  reader->header(),
                  *std::move(sculpture),
                  last_sequence,
                  last_participant,
                  Resumable(reader->participants()),
                  hash,
                  reader->dropped_hashes()};
}

}  // namespace kerf
