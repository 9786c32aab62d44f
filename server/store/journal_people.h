// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <vector>

#include "server/store/journal_error.h"
#include "server/store/journal_reader.h"

namespace kerf {

/// Returns all participants of a journal that could carve, also those who have left, in the order
/// of their numbers, without their tokens. Reads what is committed.
std::expected<std::vector<JournalParticipant>, JournalError> people_of(
    const std::filesystem::path& journal);

}  // namespace kerf
