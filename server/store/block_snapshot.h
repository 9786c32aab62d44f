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

/// What a snapshot says of its block.
struct SnapshotHead {
  std::int64_t kernel_version = 0;  ///< of the kernel that cut it
  std::string session;
  std::uint64_t sequence = 0;  ///< of the last record that it holds
  std::uint64_t hash = 0;      ///< of the solid
  std::uint64_t mark = 0;      ///< JournalReader::mark of that record
  std::uint64_t motions = 0;
};

struct SnapshotError {
  bool is_missing = false;  ///< there is no such file
  std::string reason;       ///< one sentence
};

/// The files of the newest snapshot of a journal and of the one before it, in the same folder.
std::filesystem::path snapshot_file(const std::filesystem::path& journal);
std::filesystem::path previous_snapshot_file(const std::filesystem::path& journal);

/// Writes a snapshot in place of the present one: to a temporary file, which is synchronized with
/// the disk and renamed. The present one gets the name `keep_as`, unless that is empty. Ignores
/// SnapshotHead::motions. Returns its size in bytes.
std::expected<std::uint64_t, SnapshotError> write_snapshot(
    const std::filesystem::path& file, const SnapshotHead& head, const SculptureState& state,
    const std::filesystem::path& keep_as = {});

/// Reads the head only; it is verified, the columns are not.
std::expected<SnapshotHead, SnapshotError> read_snapshot_head(const std::filesystem::path& file);

struct BlockSnapshot {
  SnapshotHead head;
  SculptureState state;
};
/// Reads and verifies a snapshot of a block with the fields of `like`, of this version of the
/// kernel. The hash of the solid must be that of the head.
std::expected<BlockSnapshot, SnapshotError> read_snapshot(const std::filesystem::path& file,
                                                          const Sculpture& like);

/// Reads and verifies the contents of a snapshot's file, of any version of the kernel.
std::expected<BlockSnapshot, SnapshotError> read_stored_snapshot(std::string contents,
                                                                 const Sculpture& like);

}  // namespace kerf
