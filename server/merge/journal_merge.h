// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/history/stroke_table.h"
#include "server/store/journal_error.h"

namespace kerf {

enum class MergeErrorCode : std::uint8_t {
  kJournal,          ///< a file cannot be read or written
  kDifferentBlock,   ///< the scenes differ
  kDifferentKernel,  ///< a file was carved by another version of the kernel
  kUnknownStroke     ///< a chosen stroke does not exist
};
/// Returns the name of a code, e.g. "different_block".
const char* to_string(MergeErrorCode code);

struct MergeError {
  MergeErrorCode code = MergeErrorCode::kJournal;
  std::string reason;  ///< one sentence
};

/// A stroke of the other journal.
struct OtherStroke {
  StrokeId id = 0;  ///< in the other journal
  std::string author;
  std::uint64_t motions = 0;  ///< that the first journal lacks
  bool is_undone = false;     ///< in the other journal
  std::int64_t begin_ms = 0;  ///< ms since 1970, UTC
};

/// The outcome of merge_journals().
struct MergedJournal {
  std::vector<OtherStroke> strokes;    ///< taken from the other journal
  std::uint64_t motions = 0;           ///< of these
  std::size_t tools = 0, people = 0;   ///< that the first journal lacked
  std::size_t undone = 0, redone = 0;  ///< strokes by changes of the other journal
  std::size_t pins = 0;                ///< that the first journal lacked
  std::uint64_t last = 0;              ///< record
  std::uint64_t hash = 0;              ///< of the block
};

/// Returns the strokes with motions that `ours` lacks, in the order of `theirs`.
std::expected<std::vector<OtherStroke>, MergeError> strokes_to_merge(
    const std::filesystem::path& ours, const std::filesystem::path& theirs,
    const std::stop_token& stop = {});

/// Appends the motions of `theirs` that the journal `ours` lacks: all, or those of the `chosen`
/// strokes. A motion cuts the same stock whatever else is cut, so the order and the number of
/// merges do not change the block. Nobody else may write `ours`; after an error it may have a part
/// of the motions.
///
/// A record is known by its origin (record_origins.h), a tool by its outline. If both journals undo
/// or redo a stroke, the change with the greater (Lamport time, writer) holds. Pins are taken;
/// named versions of `theirs` are not, because the merged journal never had their states. Does not
/// carve: MergedJournal::hash is 0.
std::expected<MergedJournal, MergeError> append_merged(const std::filesystem::path& ours,
                                                       const std::filesystem::path& theirs,
                                                       const std::optional<StrokeSet>& chosen = {},
                                                       const std::stop_token& stop = {});

/// Writes a copy of `ours` with the motions of `theirs` (append_merged), carves it and stores its
/// hash. `out` must not exist and appears once it is complete. Both journals may be in use.
std::expected<MergedJournal, MergeError> merge_journals(
    const std::filesystem::path& ours, const std::filesystem::path& theirs,
    const std::filesystem::path& out, const std::optional<StrokeSet>& chosen = {});

}  // namespace kerf
