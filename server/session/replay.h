// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "server/formats/scene.h"
#include "server/session/resumable.h"
#include "server/store/journal_reader.h"

namespace kerf {

/// The newest snapshot of a journal, the one before it, or neither.
enum class UsedSnapshot : std::uint8_t { kNone, kNewest, kPrevious };

/// The state of a session restored from its journal.
struct Replayed {
  Scene scene;
  JournalHeader header;
  Sculpture sculpture;
  SolidSnapshot start;  ///< the solid before the first record
  /// Salvaged journal: the record after which `start` was the solid. The motions before it are
  /// lost. 0 for a complete journal.
  std::uint64_t base = 0;
  std::uint64_t last_sequence = 0;
  ParticipantId last_participant = 0;
  Resumable resumable;
  Lists lists = {};
  JournalParent parent = {};
  StateHash hash;  ///< of the solid after the last record
  /// Number of stored hashes beyond the last record, which were ignored: the journal has lost its
  /// end.
  std::size_t dropped_hashes = 0;
  /// The snapshot from which the replay began, and its last record; 0 if it began from the start.
  UsedSnapshot snapshot = UsedSnapshot::kNone;
  std::uint64_t snapshot_sequence = 0;
  /// Why the newest snapshot, or both, were ignored, as one sentence; empty if none was.
  std::string snapshot_fault = {};
  std::chrono::microseconds replay_time{0};  ///< for the records after the snapshot

  /// True if another version of the kernel wrote the journal's hashes: this version has carved the
  /// block again, and it may differ from the original.
  bool is_recarved() const { return header.kernel_version != kKernelVersion; }
};

/// Applies every record of a journal to the initial block and compares the result with the newest
/// stored state hash. Errors name the file and the first record that is damaged, is rejected by the
/// kernel, or gives a different state hash. Hashes of another version of the kernel are not
/// compared (is_recarved). Fails soon after a stop was requested.
std::expected<Replayed, JournalError> replay(const std::filesystem::path& file,
                                             const std::stop_token& stop = {});

/// Returns the result of replay(), from the newest usable snapshot next to the journal and the
/// records after it. Replays all records if neither snapshot can be used. Records before the
/// snapshot are not verified.
std::expected<Replayed, JournalError> restore(const std::filesystem::path& file,
                                              const std::stop_token& stop = {});

/// Parses the scene of a journal, and adds the tools that were made since (made_tool.h). It was
/// valid when it was stored, so an invalid scene is reported as kCorrupt. Fails with kIo soon after
/// a stop was requested.
std::expected<Scene, JournalError> journal_scene(const JournalReader& reader,
                                                 const std::filesystem::path& file,
                                                 const std::stop_token& stop = {});

/// The block of a journal before its first record. first_block() fails with kIo soon after a stop
/// was requested.
struct FirstBlock {
  Sculpture sculpture;
  std::uint64_t base = 0;  ///< Replayed::base
};
std::expected<FirstBlock, JournalError> first_block(const JournalReader& reader, const Scene& scene,
                                                    const std::filesystem::path& file,
                                                    const std::stop_token& stop = {});

}  // namespace kerf
