// SPDX-License-Identifier: Apache-2.0
#include "server/store/salvage_writer.h"

#include <algorithm>
#include <span>
#include <utility>

#include "server/store/attachment.h"
#include "server/store/batch_insert.h"
#include "server/store/journal_branch.h"
#include "server/store/journal_tables.h"
#include "server/store/list_table.h"
#include "server/store/table_copy.h"

namespace kerf {
namespace {

/// Bounds of a batch, whose record times are interpolated.
constexpr std::size_t kRecordsMax = 4096;
constexpr std::int64_t kSpanMs = 20;

std::string key_text(const ListRow& row) {
  const auto* text = std::get_if<std::string>(&row.at(0));
  return text != nullptr ? *text : std::to_string(std::get<std::int64_t>(row.at(0)));
}

}  // namespace

std::unexpected<JournalError> SalvageWriter::failed(const SqlError& error) const {
  return std::unexpected(to_journal_error(file_, error));
}

std::expected<SalvageWriter, JournalError> SalvageWriter::create(const std::filesystem::path& file,
                                                                 const JournalHeader& header) {
  const auto unfinished = unfinished_journal(file);
  if (!unfinished) return std::unexpected(unfinished.error());
  auto database = create_journal(*unfinished, header, CreateMode::kCopy);
  if (!database) return std::unexpected(database.error());
  SalvageWriter writer(file, *unfinished, *std::move(database));
  auto begun = writer.database_->execute(
      "BEGIN;DELETE FROM kernel_versions;UPDATE session SET epoch=" + std::to_string(header.epoch));
  if (!begun) return writer.failed(begun.error());
  return writer;
}

SalvageWriter::SalvageWriter(SalvageWriter&& other) noexcept
    : file_(std::move(other.file_)),
      unfinished_(std::exchange(other.unfinished_, {})),
      database_(std::exchange(other.database_, std::nullopt)),
      encoder_(std::move(other.encoder_)),
      head_(other.head_),
      records_(std::move(other.records_)) {}

SalvageWriter::~SalvageWriter() {
  database_.reset();
  if (!unfinished_.empty()) remove_journal(unfinished_);
}

std::expected<void, JournalError> SalvageWriter::append(const JournalRecord& record,
                                                        bool begins_stroke) {
  const bool is_later = !records_.empty() && (record.wall_ms < head_.wall_ms + head_.span_ms ||
                                              record.wall_ms > head_.wall_ms + kSpanMs);
  if (is_later || records_.size() == kRecordsMax) {
    if (auto ok = write_batch(); !ok) return ok;
  }
  if (records_.empty()) head_ = {record.sequence, 0, record.wall_ms, 0};
  head_.span_ms = record.wall_ms - head_.wall_ms;
  records_.push_back({record.participant, record.command, begins_stroke});
  return {};
}

std::expected<void, JournalError> SalvageWriter::write_batch() {
  if (records_.empty()) return {};
  head_.count = records_.size();
  const std::vector<std::byte> bytes = encoder_.encode(records_);
  records_.clear();
  auto insert = prepare_batch_insert(*database_);
  if (!insert) return failed(insert.error());
  if (auto ok = insert_batch(*insert, head_, bytes); !ok) return failed(ok.error());
  return {};
}

std::expected<std::vector<std::string>, JournalError> SalvageWriter::copy_rest(
    const std::filesystem::path& from, const JournalReader& journal, std::uint64_t first,
    std::uint64_t last, std::uint64_t hashes_end) {
  auto source = open_journal(from, SqlMode::kRead);
  if (!source) return std::unexpected(source.error());
  std::vector<std::string> left_out;
  const auto copy = [&](const std::string& table, const std::string& where) {
    const auto copied = copy_table(*source, *database_, table, where);
    if (!copied) left_out.push_back("of the table " + table + ": " + copied.error().reason);
  };
  const std::string up_to_last = "sequence<=" + std::to_string(last);
  copy("participants", "");
  copy("kernel_versions", up_to_last);
  copy("state_hashes", up_to_last + " AND sequence>=" + std::to_string(first) + " AND sequence<" +
                           std::to_string(hashes_end));
  copy("program_lines", "");
  if (!journal.parent().session.empty()) copy("parent", "");
  for (const auto& [name, rows] : journal.lists()) {
    const JournalTable& table = *std::ranges::find(kJournalTables, name, &JournalTable::name);
    for (const ListRow& row : rows) {
      const std::uint64_t record = record_of(table, row);
      if (record > last || (table.needs_record && record < first)) {
        left_out.push_back("the row " + key_text(row) + " of the table " + name + ", of record " +
                           std::to_string(record));
      } else if (auto ok = store_list_change(*database_, {.table = name, .stored = row}); !ok) {
        return failed(ok.error());
      }
    }
  }
  auto agent = database_->prepare("INSERT INTO agents VALUES(?,?,?,?)");
  if (!agent) return failed(agent.error());
  for (const JournalParticipant& one : journal.participants()) {
    if (!one.token) continue;
    const auto token = std::as_bytes(std::span(*one.token));
    agent->bind(1, std::int64_t{one.participant});
    agent->bind(2, token);
    agent->bind(3, static_cast<std::int64_t>(one.agent_sequence));
    agent->bind(4, std::int64_t{progress_checksum(one.participant, one.agent_sequence, token)});
    if (auto row = agent->step(); !row) return failed(row.error());
  }
  const auto attachments = read_attachments(from);
  if (!attachments) left_out.push_back("attachments: " + attachments.error().reason);
  std::int64_t number = 0;
  for (const Attachment& one : attachments.value_or(std::vector<Attachment>())) {
    auto ok = store_attachment(*database_, {one.kind, one.name, one.bytes}, ++number);
    if (!ok) return failed(ok.error());
  }
  return left_out;
}

std::expected<std::filesystem::path, JournalError> SalvageWriter::commit() {
  if (auto ok = write_batch(); !ok) return std::unexpected(ok.error());
  if (auto ok = database_->execute("COMMIT; PRAGMA journal_mode=WAL"); !ok) {
    return failed(ok.error());
  }
  database_.reset();
  return unfinished_;
}

std::expected<void, JournalError> SalvageWriter::finish() {
  if (const std::error_code error = rename_new(unfinished_, file_)) {
    const auto code =
        error == std::errc::file_exists ? JournalErrorCode::kExists : JournalErrorCode::kIo;
    return std::unexpected(JournalError{code, file_.string(), 0, error.message()});
  }
  remove_journal(std::exchange(unfinished_, {}));  // a log left by a reader
  return {};
}

}  // namespace kerf
