// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_people.h"

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

}  // namespace kerf
