// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#include "kernel/math/hash.h"
#include "server/store/attachment.h"
#include "server/store/crc32.h"
#include "server/store/journal_people.h"

namespace kerf {

JournalReader::JournalReader(std::filesystem::path file, SqlDatabase database, RecordOrder order,
                             std::stop_token stop)
    : file_(std::move(file)),
      database_(std::make_unique<SqlDatabase>(std::move(database))),
      order_(order),
      stop_(std::move(stop)) {}

JournalError JournalReader::corrupt(std::uint64_t sequence, std::string reason) const {
  return {JournalErrorCode::kCorrupt, file_.string(), sequence, std::move(reason)};
}

std::expected<JournalReader, JournalError> JournalReader::open(const std::filesystem::path& file,
                                                               RecordOrder order,
                                                               std::stop_token stop,
                                                               std::uint64_t from) {
  auto database = open_journal(file, SqlMode::kRead);
  if (!database) return std::unexpected(database.error());
  if (stop.stop_possible()) database->end_on(stop);
  // One read transaction, so that hashes and commands belong to the same state.
  if (auto ok = database->execute("BEGIN"); !ok) {
    return std::unexpected(to_journal_error(file, ok.error()));
  }
  JournalReader reader(file, *std::move(database), order, std::move(stop));
  auto rows = RecordRows::open(file, *reader.database_, from);
  if (!rows) return std::unexpected(rows.error());
  reader.rows_ = *std::move(rows);
  if (auto ok = reader.read_head(); !ok) return std::unexpected(ok.error());
  return reader;
}

std::expected<void, JournalError> JournalReader::read_head() {
  const auto each = [&](std::string_view sql, auto&& use) -> std::expected<void, JournalError> {
    auto statement = database_->prepare(sql);
    if (!statement) return std::unexpected(to_journal_error(file_, statement.error()));
    for (;;) {
      const auto row = statement->step();
      if (!row) return std::unexpected(to_journal_error(file_, row.error()));
      if (!*row) return {};
      use(*statement);
    }
  };
  std::int64_t crc = -1;
  auto ok =
      each("SELECT id, scene, crc, base_folder, epoch FROM session", [&](const SqlStatement& row) {
        header_ = {
            row.text(0), row.text(1), row.text(3), static_cast<std::uint32_t>(row.integer(4)), {}};
        crc = row.integer(2);
      });
  if (!ok) return ok;
  if (crc != std::int64_t{crc32(std::as_bytes(std::span(header_.scene_json)))}) {
    return std::unexpected(corrupt(0, "the scene is missing or its checksum is wrong"));
  }
  const auto has_files = has_table("files");
  if (!has_files) return std::unexpected(has_files.error());
  std::string damaged;
  if (*has_files) {
    ok = each("SELECT name, bytes, crc FROM files", [&](const SqlStatement& row) {
      const auto bytes = row.blob(1);
      if (row.integer(2) != std::int64_t{crc32(bytes)}) damaged = row.text(0);
      header_.files[row.text(0)].assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    });
    if (!ok) return ok;
  }
  const auto last = static_cast<std::int64_t>(rows_->last());
  ok = read_kernel_version(last);
  if (!ok) return ok;
  if (!damaged.empty()) {
    return std::unexpected(corrupt(0, "the checksum of the scene's file " + damaged + " is wrong"));
  }
  ok = each("SELECT participant, name, color, kind FROM participants ORDER BY participant",
            [&](const SqlStatement& row) {
              participants_.push_back({static_cast<ParticipantId>(row.integer(0)), row.text(1),
                                       row.text(2), row.text(3)});
            });
  if (!ok) return ok;
  ok = read_agents();
  if (!ok) return ok;
  auto lists = read_lists(*database_, rows_->last());
  if (!lists) return std::unexpected(to_journal_error(file_, lists.error()));
  lists_ = *std::move(lists);
  auto parent = read_parent(*database_);
  if (!parent) return std::unexpected(to_journal_error(file_, parent.error()));
  parent_ = *std::move(parent);
  return each("SELECT sequence, hash FROM state_hashes ORDER BY sequence",
              [&](const SqlStatement& row) {
                if (row.integer(0) > last) {
                  ++dropped_hashes_;
                  return;
                }
                hashes_.push_back({static_cast<std::uint64_t>(row.integer(0)),
                                   std::bit_cast<std::uint64_t>(row.integer(1))});
              });
}

std::expected<bool, JournalError> JournalReader::has_table(const std::string& name) {
  const auto found = database_->has_table(name);
  if (!found) return std::unexpected(to_journal_error(file_, found.error()));
  return *found;
}

std::expected<void, JournalError> JournalReader::read_agents() {
  const auto has_agents = has_table("agents");
  if (!has_agents) return std::unexpected(has_agents.error());
  if (!*has_agents) return {};
  auto rows = database_->prepare("SELECT participant, token, agent_sequence, crc FROM agents");
  if (!rows) return std::unexpected(to_journal_error(file_, rows.error()));
  for (;;) {
    const auto row = rows->step();
    if (!row) return std::unexpected(to_journal_error(file_, row.error()));
    if (!*row) return {};
    const auto id = static_cast<ParticipantId>(rows->integer(0));
    const auto agent_sequence = static_cast<std::uint64_t>(rows->integer(2));
    const auto token = agent_token(id, agent_sequence, rows->blob(1), rows->integer(3));
    if (!token) continue;  // the agent joins as a new participant
    const auto found =
        std::ranges::lower_bound(participants_, id, {}, &JournalParticipant::participant);
    if (found == participants_.end() || found->participant != id) continue;
    found->agent_sequence = agent_sequence;
    found->token = token;
  }
}

std::expected<std::vector<JournalReader::DamagedRows>, JournalError> JournalReader::damaged_rows() {
  struct Table {
    std::string name, rows;  ///< condition for rows of existing records
    std::int64_t good = 0;
  };
  const auto agents = std::ranges::count_if(
      participants_, [](const JournalParticipant& one) { return one.token.has_value(); });
  std::vector<Table> tables = {
      {"agents", " WHERE participant IN (SELECT participant FROM participants)", agents}};
  tables.push_back({"parent", "", parent_.session.empty() ? 0 : 1});
  std::vector<DamagedRows> damaged;
  for (const Table& table : tables) {
    const auto exists = has_table(table.name);
    if (!exists) return std::unexpected(exists.error());
    if (!*exists) continue;
    const auto rows = integer("SELECT COUNT(*) FROM " + table.name + table.rows);
    if (!rows) return std::unexpected(rows.error());
    if (*rows > table.good) damaged.push_back({table.name, *rows - table.good});
  }
  const auto lists = damaged_list_rows(*database_);
  if (!lists) return std::unexpected(to_journal_error(file_, lists.error()));
  for (const auto& [name, rows] : *lists) damaged.push_back({name, rows});
  const auto attachments = damaged_attachments(*database_);
  if (!attachments) return std::unexpected(to_journal_error(file_, attachments.error()));
  if (*attachments > 0) damaged.push_back({"attachments", *attachments});
  return damaged;
}

std::expected<std::optional<std::uint64_t>, JournalError> JournalReader::mark(
    std::uint64_t sequence) {
  Hash hash;
  hash.add(crc32(std::as_bytes(std::span(header_.session))));
  hash.add(crc32(std::as_bytes(std::span(header_.scene_json))));
  hash.add(sequence);
  const std::string at = std::to_string(sequence);
  const std::pair<const char*, std::string> queries[] = {
      {"batches", "SELECT first, count, wall_ms, span_ms, crc FROM batches WHERE first<=" + at +
                      " AND first+count>" + at + " ORDER BY first DESC LIMIT 1"},
      {"commands", "SELECT sequence, participant, crc, 0, 0 FROM commands WHERE sequence=" + at}};
  for (const auto& [table, query] : queries) {
    const auto exists = has_table(table);
    if (!exists) return std::unexpected(exists.error());
    if (!*exists) continue;
    auto row = database_->prepare(query);
    if (!row) return std::unexpected(to_journal_error(file_, row.error()));
    const auto found = row->step();
    if (!found) return std::unexpected(to_journal_error(file_, found.error()));
    if (!*found) continue;
    for (int n = 0; n < 5; ++n) hash.add(static_cast<std::uint64_t>(row->integer(n)));
    return hash.value();
  }
  return std::nullopt;
}

std::expected<std::int64_t, JournalError> JournalReader::integer(const std::string& sql) {
  const auto value = database_->integer(sql);
  if (!value) return std::unexpected(to_journal_error(file_, value.error()));
  return *value;
}

std::expected<void, JournalError> JournalReader::read_kernel_version(std::int64_t last) {
  header_.kernel_version = kFirstKernelVersion;
  const auto has_versions = has_table("kernel_versions");
  if (!has_versions) return std::unexpected(has_versions.error());
  if (!*has_versions) return {};
  const std::string newest = " FROM kernel_versions WHERE sequence<=" + std::to_string(last) +
                             " ORDER BY sequence DESC LIMIT 1),";
  const auto version = integer("SELECT coalesce((SELECT version" + newest +
                               std::to_string(kFirstKernelVersion) + ")");
  if (!version) return std::unexpected(version.error());
  const auto since = integer("SELECT coalesce((SELECT sequence" + newest + "0)");
  if (!since) return std::unexpected(since.error());
  header_.kernel_since = static_cast<std::uint64_t>(*since);
  header_.kernel_version = *version;
  return {};
}

std::expected<std::optional<JournalRecord>, JournalError> JournalReader::next() {
  if (order_ == RecordOrder::kSequence) return rows_->next();
  if (!sorted_) {
    auto sorted = SortedRecords::sort(*rows_, file_, stop_);
    if (!sorted) return std::unexpected(sorted.error());
    sorted_ = *std::move(sorted);
  }
  return sorted_->next();
}

}  // namespace kerf
