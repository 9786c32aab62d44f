// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <string>

#include "kernel/sculpture_state.h"

namespace kerf {

class Sculpture;

/// Version of the format of snapshot files. A file of another version is ignored.
inline constexpr std::uint32_t kSnapshotVersion = 1;

/// The properties of a snapshot's block.
struct SnapshotHead {
  std::int64_t kernel_version = 0;  ///< kernel version that computed it
  std::string session;
  std::uint64_t sequence = 0;  ///< last record included
  std::uint64_t hash = 0;      ///< hash of the solid
  std::uint64_t mark = 0;      ///< JournalReader::mark of that record
  std::uint64_t motions = 0;
};

struct SnapshotError {
  bool is_missing = false;  ///< the file does not exist
  std::string reason;       ///< one sentence
};

/// The files of the newest snapshot of a journal and of the previous one, in the journal's folder.
std::filesystem::path snapshot_file(const std::filesystem::path& journal);
std::filesystem::path previous_snapshot_file(const std::filesystem::path& journal);

/// Writes a snapshot over `file` atomically: to a temporary file, which is synchronized and
/// renamed. Unless `keep_as` is empty, the old snapshot is renamed to it. Ignores
/// SnapshotHead::motions. Returns the size in bytes.
std::expected<std::uint64_t, SnapshotError> write_snapshot(
    const std::filesystem::path& file, const SnapshotHead& head, const SculptureState& state,
    const std::filesystem::path& keep_as = {});

/// Reads and verifies the head only.
std::expected<SnapshotHead, SnapshotError> read_snapshot_head(const std::filesystem::path& file);

struct BlockSnapshot {
  SnapshotHead head;
  SculptureState state;
};
/// Reads and verifies a snapshot by this version of the kernel of a block with the fields of
/// `like`. The hash of the solid must match that of the head.
std::expected<BlockSnapshot, SnapshotError> read_snapshot(const std::filesystem::path& file,
                                                          const Sculpture& like);

/// Reads and verifies the contents of a snapshot file, from any version of the kernel.
std::expected<BlockSnapshot, SnapshotError> read_stored_snapshot(std::string contents,
                                                                 const Sculpture& like);

}  // namespace kerf
