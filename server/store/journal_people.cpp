// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_people.h"

#include <algorithm>

#include "server/store/journal_file.h"

namespace kerf {

std::expected<std::vector<JournalParticipant>, JournalError> people_of(
    const std::filesystem::path& journal) {
  auto database = open_journal(journal, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  const auto failed = [&](const SqlError& error) {
    return std::unexpected(to_journal_error(journal, error));
  };
  auto rows = database->prepare(
      "SELECT participant, name, color, kind FROM participants ORDER BY participant");
  if (!rows) return failed(rows.error());
  std::vector<JournalParticipant> people;
  for (;;) {
    const auto row = rows->step();
    if (!row) return failed(row.error());
    if (!*row) return people;
    people.push_back({static_cast<ParticipantId>(rows->integer(0)), rows->text(1), rows->text(2),
                      rows->text(3)});
  }
}

std::optional<TokenHash> agent_token(ParticipantId participant, std::uint64_t agent_sequence,
                                     std::span<const std::byte> token, std::int64_t crc) {
  if (token.size() != kTokenHashBytes ||
      crc != std::int64_t{progress_checksum(participant, agent_sequence, token)}) {
    return std::nullopt;
  }
  TokenHash hash{};
  std::ranges::copy(token, hash.begin());
  return hash;
}

std::expected<std::optional<JournalParticipant>, JournalError> agent_of(
    const std::filesystem::path& journal, ParticipantId participant) {
  auto database = open_journal(journal, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  const auto failed = [&](const SqlError& error) {
    return std::unexpected(to_journal_error(journal, error));
  };
  auto rows = database->prepare(
      "SELECT name, color, kind, token, agent_sequence, crc FROM agents "
      "JOIN participants USING(participant) WHERE participant=?");
  if (!rows) return failed(rows.error());
  rows->bind(1, std::int64_t{participant});
  const auto row = rows->step();
  if (!row) return failed(row.error());
  if (!*row) return std::nullopt;
  JournalParticipant agent{participant, rows->text(0), rows->text(1), rows->text(2)};
  agent.agent_sequence = static_cast<std::uint64_t>(rows->integer(4));
  agent.token = agent_token(participant, agent.agent_sequence, rows->blob(3), rows->integer(5));
  if (agent.token) return agent;
  return std::unexpected(
      JournalError{JournalErrorCode::kCorrupt, journal.string(), 0,
                   "the checksum of agent " + std::to_string(participant) + " is wrong"});
}

}  // namespace kerf
