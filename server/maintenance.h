// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace kerf {

/// `kerf-server check`: prints one line for each journal and snapshot of a data folder. Returns the
/// exit status: 0, or 1 on any fault. The lines state the fault and the remedy.
int check_data(const std::filesystem::path& folder);

/// `kerf-server backup`: copies the journals and the rights of a data folder, also of a running
/// server, into another folder, which is created. Each copy has everything committed when it was
/// begun. Snapshots are optional. Prints one line for each. Each copy is verified. A damaged
/// journal is copied unchanged. Returns the exit status: 0, or 1 if one is damaged or cannot be
/// copied, e.g. because a file of its name exists. The remaining ones are still copied.
int back_up(const std::filesystem::path& data, const std::filesystem::path& to);

/// `kerf-server replay`: carves a journal from the start, compares it with its stored hashes and
/// its snapshot, and prints the outcome. Returns the exit status: 0, or 1 if something differs or
/// the journal cannot be read.
int replay_journal(const std::filesystem::path& file);

/// `kerf-server replay --without-strokes`: carves a journal without some strokes, and without those
/// undone at its end, and prints the hash of the block. Returns the exit status: 0, or 1 if a
/// stroke does not exist or the journal cannot be read.
int replay_without(const std::filesystem::path& file, const std::vector<std::uint64_t>& strokes);

/// `kerf-server salvage`: writes the readable part of a damaged journal to a new one
/// (salvage_journal), and prints its content and the losses. Returns the exit status: 0, or 1 if
/// nothing can be salvaged or the new journal cannot be written.
int salvage(const std::filesystem::path& file, const std::filesystem::path& to);

/// `kerf-server merge`: writes to `to` a journal with the strokes of two copies of a block
/// (merge_journals), and prints the strokes that `ours` lacked. If `to` is empty, only prints them.
/// Returns the exit status: 0, or 1 if they cannot be merged.
int merge(const std::filesystem::path& ours, const std::filesystem::path& theirs,
          const std::filesystem::path& to, const std::vector<std::uint64_t>& strokes);

}  // namespace kerf
