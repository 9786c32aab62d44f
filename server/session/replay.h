// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <functional>

#include "server/formats/scene.h"
#include "server/store/journal_reader.h"

namespace kerf {

/// A session as its journal brings it back.
struct Replayed {
  Scene scene;
  JournalHeader header;
  Sculpture sculpture;
  std::uint64_t last_sequence = 0;
  ParticipantId last_participant = 0;
  StateHash hash;  ///< of the solid after the last record
};

/// Applies every record of a journal to a fresh block and compares with the newest state hash that
/// it stores. Errors name the file and the first record that is damaged, that the kernel rejects,
/// or at which the solid differs.
std::expected<Replayed, JournalError> replay(const std::filesystem::path& file);

/// The scene of a journal: its text was valid when it was stored, so a failure is reported as
/// damage.
std::expected<Scene, JournalError> journal_scene(const JournalReader& reader,
                                                 const std::filesystem::path& file);

}  // namespace kerf
