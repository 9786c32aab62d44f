// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <string>

#include "server/history/stroke_table.h"

namespace kerf {

/// A block that was carved from a journal.
struct CarvedJournal {
  std::uint64_t motions = 0, hash = 0;
  double removed_mm3 = 0;
};

/// Carves a journal from its first record as if some strokes, and those undone at its end, had
/// never happened. Changes no file. The error is one sentence, e.g. for a stroke that does not
/// exist.
std::expected<CarvedJournal, std::string> carve_without(const std::filesystem::path& journal,
                                                        const StrokeSet& without);

}  // namespace kerf
