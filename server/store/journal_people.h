// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "server/store/journal_error.h"
#include "server/store/journal_reader.h"

namespace kerf {

/// Returns all committed participants of a journal that could carve, including those that have
/// left, by ascending number and without tokens.
std::expected<std::vector<JournalParticipant>, JournalError> people_of(
    const std::filesystem::path& journal);

/// Returns the token of a row of the table `agents`; nullopt if the row is damaged.
std::optional<TokenHash> agent_token(ParticipantId participant, std::uint64_t agent_sequence,
                                     std::span<const std::byte> token, std::int64_t crc);

/// Returns an agent that may resume, with its token and its newest committed sample. Nullopt if
/// there is no such agent, kCorrupt if its row is damaged. Reads two rows by their keys.
std::expected<std::optional<JournalParticipant>, JournalError> agent_of(
    const std::filesystem::path& journal, ParticipantId participant);

}  // namespace kerf
