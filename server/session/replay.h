// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <functional>

#include "server/formats/scene.h"
#include "server/session/resumable.h"
#include "server/store/journal_reader.h"

namespace kerf {

/// The state of a session restored from its journal.
struct Replayed {
  Scene scene;
  JournalHeader header;
  Sculpture sculpture;
  std::uint64_t last_sequence = 0;
  ParticipantId last_participant = 0;
  Resumable resumable;
  StateHash hash;  ///< of the solid after the last record
  /// Stored hashes beyond the last record, which were ignored: the journal has lost its end.
  std::size_t dropped_hashes = 0;

  /// The journal's hashes are of another version of the kernel: the block has been carved again by
  /// this one, and may differ from what was cut then.
  bool is_recarved() const { return header.kernel_version != kKernelVersion; }
};

/// Applies every record of a journal to the initial block and compares the result with the newest
/// stored state hash. Errors name the file and the first record that is damaged, is rejected by the
/// kernel, or gives a different state hash. Hashes of another version of the kernel are not
/// compared (is_recarved).
std::expected<Replayed, JournalError> replay(const std::filesystem::path& file);

/// Parses the scene of a journal. It was valid when it was stored, so an invalid scene is reported
/// as kCorrupt.
std::expected<Scene, JournalError> journal_scene(const JournalReader& reader,
                                                 const std::filesystem::path& file);

}  // namespace kerf
